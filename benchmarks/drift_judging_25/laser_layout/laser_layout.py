#!/usr/bin/env python
"""Projects the marks of a floor plan with a laser that pans and tilts on a tripod, for the fitters of a hall.

The origin is below the pan axis. x points ahead, y to the left; pan is positive to the left, tilt is positive down.
"""

import math
from collections import deque, namedtuple

import rospy
from geometry_msgs.msg import Point
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float32, String

Mount = namedtuple(
    "Mount", "height offset"
)  # m: of the tilt axis above the floor, of the beam left of the pan axis
Angles = namedtuple("Angles", "pan tilt")

MOUNT = Mount(height=1.42, offset=0.03)
PAN_LIMIT = 2.6
TILT_LIMITS = (0.1, 1.4)
MAX_RATE = 1.2  # rad/s
GAIN = 3.0
ON_TARGET = 0.0015  # rad
SHOW = 1.2  # s
MAX_LEVEL = 0.01  # rad, of the tripod

marks = deque()
angles = None
levelled = True
shown_since = None
done = 0
publishers = {}


def aim(x, y, mount=MOUNT):
    """Return the angles at which the beam hits a point of the floor, or None if it cannot."""
    far = math.hypot(x, y)
    if far <= abs(mount.offset):
        return None
    ahead = math.sqrt(far * far - mount.offset * mount.offset)
    pan = math.atan2(y, x) - math.asin(mount.offset / far)
    tilt = math.atan2(mount.height, ahead)
    if abs(pan) > PAN_LIMIT or not TILT_LIMITS[0] <= tilt <= TILT_LIMITS[1]:
        return None
    return Angles(pan, tilt)


def on_mark(msg):
    marks.append((msg.x, msg.y))


def on_joints(msg):
    global angles
    by_name = dict(zip(msg.name, msg.position))
    angles = Angles(by_name["pan"], by_name["tilt"])


def on_level(msg):
    global levelled
    if abs(msg.data) > MAX_LEVEL and levelled:
        rospy.logwarn("tripod leans by %.3f rad", msg.data)
    levelled = abs(msg.data) <= MAX_LEVEL


def rate(error):
    return max(-MAX_RATE, min(MAX_RATE, GAIN * error))


def next_mark(how):
    global shown_since, done
    mark = marks.popleft()
    rospy.loginfo("mark at %.2f, %.2f: %s", mark[0], mark[1], how)
    shown_since = None
    done += 1


def tick(event):
    global shown_since
    command = JointState(name=["pan", "tilt"], velocity=[0.0, 0.0])
    beam = False
    if marks and angles is not None and levelled:
        goal = aim(*marks[0])
        if goal is None:
            next_mark("out of reach")
        else:
            pan_error = goal.pan - angles.pan
            tilt_error = goal.tilt - angles.tilt
            command.velocity = [rate(pan_error), rate(tilt_error)]
            if max(abs(pan_error), abs(tilt_error)) < ON_TARGET and shown_since is None:
                shown_since = rospy.get_time()
            beam = shown_since is not None
            if beam and rospy.get_time() - shown_since > SHOW:
                next_mark("shown")
                beam = False
    publishers["joints"].publish(command)
    publishers["beam"].publish(beam)
    publishers["progress"].publish("%d of %d" % (done, done + len(marks)))


def main():
    rospy.init_node("laser_layout")
    publishers["joints"] = rospy.Publisher("head/command", JointState, queue_size=1)
    publishers["beam"] = rospy.Publisher("laser/on", Bool, queue_size=1)
    publishers["progress"] = rospy.Publisher("layout/progress", String, queue_size=1)
    rospy.Subscriber("plan/mark", Point, on_mark)
    rospy.Subscriber("head/joints", JointState, on_joints)
    rospy.Subscriber("tripod/level", Float32, on_level)
    rospy.Timer(rospy.Duration(0.1), tick)
    rospy.spin()


if __name__ == "__main__":
    main()
