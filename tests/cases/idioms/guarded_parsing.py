"""`try` with `else` and `finally`, exceptions of one's own that carry data, re-raised and chained."""

import rospy
from std_msgs.msg import Float64, String


class ParseError(Exception):
    """A line that cannot be read."""


class RangeError(ParseError):
    def __init__(self, value, limit):
        super().__init__("%s exceeds %s" % (value, limit))
        self.value = value
        self.limit = limit


class Parser:
    def __init__(self):
        self.good = rospy.Publisher("good", Float64, queue_size=1)
        self.bad = rospy.Publisher("bad", String, queue_size=1)
        self.excess = rospy.Publisher("excess", Float64, queue_size=1)
        self.limit = rospy.Publisher("limit", Float64, queue_size=1)
        self.done = rospy.Publisher("done", String, queue_size=1)
        rospy.Subscriber("line", String, self.on_line)  # source line
        rospy.Subscriber("other", String, self.on_other)  # source other

    def read(self, text):
        key, _, number = text.partition("=")
        if key != "v":
            raise ParseError("unknown key " + key)
        value = float(number)
        if value > 10.0:
            raise RangeError(value, 10.0)
        return value

    def checked(self, text):
        try:
            return self.read(text)
        except RangeError:
            raise
        except ValueError as error:
            raise ParseError("no number") from error

    def on_line(self, msg):
        try:
            value = self.checked(msg.data)
        except RangeError as error:
            self.excess.publish(error.value)  # sink line
            self.limit.publish(error.limit)  # sink ~line
        except ParseError as error:
            self.bad.publish(str(error))  # sink line
        else:
            self.good.publish(value)  # sink line
        finally:
            self.done.publish("line done")  # clean

    def on_other(self, msg):
        words = msg.data.split(",")
        try:
            self.good.publish(float(words[3]))  # sink other
        except (IndexError, ValueError):
            self.bad.publish("malformed")  # sink ~other


if __name__ == "__main__":
    rospy.init_node("parser")
    Parser()
    rospy.spin()
