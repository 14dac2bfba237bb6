import rospy

rospy.init_node("prober")
for number in range(3):
    rospy.loginfo_once("once %d", number)
    rospy.logwarn_throttle(1.0, "throttled")
say(rospy.DEBUG, rospy.INFO, rospy.WARN, rospy.ERROR, rospy.FATAL)
say(issubclass(rospy.ROSInterruptException, rospy.ROSException), issubclass(rospy.ROSInterruptException, KeyboardInterrupt))
say(issubclass(rospy.ROSInitException, rospy.ROSException), issubclass(rospy.ServiceException, Exception))
say(issubclass(rospy.ROSSerializationException, rospy.ROSException), issubclass(rospy.exceptions.TransportException, rospy.ROSInternalException))
