import rospy

rospy.init_node("prober", argv=["prober", "chatter:=/loud/chatter", "_rate:=7", "~own:=/elsewhere"])
for name in ("chatter", "/chatter", "~chatter", "a/b", "/a//b", "~own"):
    say(name, rospy.resolve_name(name))
say(rospy.get_name(), rospy.get_caller_id(), rospy.get_namespace())
say(rospy.get_param("~rate"), rospy.get_param("/prober/rate"))
say(rospy.myargv(["prog", "a:=b", "_x:=1", "plain", "--flag"]))
