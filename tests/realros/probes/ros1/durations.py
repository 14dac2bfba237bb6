import rospy

rospy.init_node("prober")
Duration, Time = rospy.Duration, rospy.Time
a, b = Duration(1, 500000000), Duration(0.25)
say(a, repr(a), a.secs, a.nsecs, a.to_sec(), a.to_nsec())
say(a + b, a - b, -b, abs(-b), a * 2, a * 0.5, a / 2, a // b, a / b, a % b)
say(a > b, a == Duration(1.5), a != b, bool(Duration(0)), Duration(-0.5).secs, Duration(-0.5).nsecs)
t = Time(3, 250000000)
say(t, repr(t), t + a, t - a, t - Time(1), t > Time(2), t.is_zero(), Time(0).is_zero())
say(Time.from_sec(1.1), Duration.from_sec(0.1), Time(1.75), type(t - a).__name__, type(t - t).__name__)
for action in (lambda: t + t, lambda: a + 1, lambda: a < 1, lambda: Time(-1), lambda: Duration("x"), lambda: a * a):
    try:
        say(action())
    except Exception as error:
        say(type(error).__name__)
