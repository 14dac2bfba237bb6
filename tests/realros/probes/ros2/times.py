import rclpy
from rclpy.clock import ClockType
from rclpy.duration import Duration
from rclpy.time import Time

rclpy.init()
a, b = Duration(seconds=1.5), Duration(nanoseconds=250)
say(a, a.nanoseconds, a == Duration(seconds=1, nanoseconds=500000000), a > b, a.to_msg())
t = Time(seconds=3, nanoseconds=5)
say(t, t.nanoseconds, t.seconds_nanoseconds(), t + a, t - a, t - Time(seconds=1), t.to_msg())
say(Time.from_msg(t.to_msg()) == Time(seconds=3, nanoseconds=5, clock_type=ClockType.ROS_TIME), t.clock_type)
say(Time() == Time(nanoseconds=0), Time(seconds=1) < Time(seconds=2), Duration.from_msg(a.to_msg()).nanoseconds)
for action in (
    lambda: t + t,
    lambda: t + 1,
    lambda: Time(seconds=-1),
    lambda: t < a,
    lambda: t == Time(seconds=3, nanoseconds=5, clock_type=ClockType.ROS_TIME),
    lambda: t < Time(seconds=3, clock_type=ClockType.ROS_TIME),
    lambda: t - Time(seconds=1, clock_type=ClockType.ROS_TIME),
):
    try:
        say(action())
    except Exception as error:
        say(type(error).__name__)
