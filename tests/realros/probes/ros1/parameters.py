import rospy

rospy.init_node("prober")
rospy.set_param("gain", 2.5)
rospy.set_param("~tree", {"a": 1, "b": {"c": "x"}})
say(rospy.get_param("gain"), rospy.get_param("~tree"), rospy.get_param("~tree/b/c"))
say(rospy.get_param("missing", 3), rospy.has_param("missing"), rospy.has_param("~tree/a"))
say(rospy.search_param("gain"), rospy.search_param("tree"), rospy.search_param("nowhere"))
rospy.delete_param("~tree/a")
say(rospy.get_param("~tree"))
for action in (lambda: rospy.get_param("missing"), lambda: rospy.delete_param("missing")):
    try:
        action()
    except Exception as error:
        say(type(error).__name__, error.args)
for value in (1, 1.5, True, "text", [1, 2, "x"], {"k": [1.0]}):
    rospy.set_param("value", value)
    say(type(rospy.get_param("value")).__name__, rospy.get_param("value"))
