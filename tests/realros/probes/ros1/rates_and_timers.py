import rospy

rospy.init_node("prober")
rospy.Timer(rospy.Duration(0.1), lambda event: say("timer", rospy.get_time(), event.current_expected))
rospy.Timer(rospy.Duration(0.25), lambda event: say("once", rospy.get_time(), event.last_real), oneshot=True)
rate = rospy.Rate(5)
for _ in range(3):
    say("loop", rospy.get_time(), rate.remaining())
    rate.sleep()
rospy.sleep(0.05)
say("slept", rospy.get_time(), rospy.Time.now())
rospy.sleep(rospy.Duration(0))
rospy.sleep(-1)
say("again", rospy.get_time())
