"""A buffer in memory returns the data written to it, a port does not; some functions fill their arguments."""

import io
import struct

import rospy
import serial
from cv_bridge import CvBridge
from sensor_msgs.msg import Image
from std_msgs.msg import Float64, Int32, String, UInt8MultiArray

port = serial.Serial("/dev/ttyUSB0", 115200, timeout=0.1)
bridge = CvBridge()
packer = struct.Struct("<f")


def on_speed(msg):
    frame = bytearray(4)
    struct.pack_into("<f", frame, 0, msg.data)
    frames.publish(list(frame))  # sink speed
    other = bytearray(4)
    packer.pack_into(other, 0, msg.data)
    frames.publish(list(other))  # sink speed
    port.write(frame)
    memory = io.BytesIO()
    memory.write(frame)
    memory.seek(0)
    texts.publish(memory.read().hex())  # sink speed


def on_image(msg):
    image = bridge.imgmsg_to_cv2(msg)
    height, width = image.shape
    image[0] = 255
    ticks.publish(width // 2)  # sink image


def poll(event):
    line = port.readline()
    if len(line) == 8:
        ticks.publish(struct.unpack("<i", line[:4])[0])  # clean


rospy.init_node("bridge")
frames = rospy.Publisher("frames", UInt8MultiArray, queue_size=1)
texts = rospy.Publisher("texts", String, queue_size=1)
ticks = rospy.Publisher("ticks", Int32, queue_size=1)
rospy.Subscriber("speed", Float64, on_speed)  # source speed
rospy.Subscriber("image", Image, on_image)  # source image
rospy.Timer(rospy.Duration(0.1), poll)
rospy.spin()
