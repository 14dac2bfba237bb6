from std_msgs.msg import Float64


def number(value):
    return Float64(data=value)
