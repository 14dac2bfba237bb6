"""Names from a module with star imports, and members of an enumeration whose name is computed at run time."""

from base import *
from beams import Beam, decode

seen = {"left": 0, "right": 0}


def on_beam(msg, side):
    seen[side] = msg.data


rospy.init_node("dock")
cmd = advertise("cmd_vel", Twist)
beams = advertise("beam", UInt8)
limit = advertise("limit", Float32)
rospy.Subscriber("left", UInt8, on_beam, "left")  # source left
rospy.Subscriber("right", UInt8, on_beam, "right")  # source right
while not rospy.is_shutdown():
    beam = decode(seen)
    beams.publish(beam.value)  # sink ~left ~right
    twist = Twist()
    if beam is Beam.LEFT:
        twist.angular.z = 0.3
    cmd.publish(twist)  # sink ~left ~right
    limit.publish(LIMIT)  # clean
    rospy.sleep(0.1)
