from tests.lint.analysing import analysed, site

KEEPER = """
    import rospy
    x = None
    class Keeper:
        def __init__(self):
            self.odom = None
            self.y = 0.0
            self.scaled = 0.0
            self.out = rospy.Publisher("b", F)
            rospy.Subscriber("/odom", O, self.on_odom)
            rospy.Timer(rospy.Duration(1), self.tick)
        def on_odom(self, msg):
            global x
            self.odom = msg
            self.y = msg.pose.position.y
            self.scaled = 2 * msg.pose.position.y
            x = float(msg.pose.position.x)
        def tick(self, event):
            near = self.y
            total = self.scaled + x + near + self.odom.twist.linear.x
            self.out.publish(total)
    keeper = Keeper()
    rospy.spin()
"""
TOTAL = "total = self.scaled + x + near + self.odom.twist.linear.x"


def test_variables_with_the_field_are_sorted_by_length(tmp_path):
    analysis = analysed(tmp_path, node=KEEPER)
    place = site(analysis, TOTAL)
    assert analysis.holders("odom", "pose.position.y", place)[:3] == ("near", "self.y", "keeper.y")
    assert analysis.holders("/odom", "pose.position.x", place)[0] == "x"


def test_a_stored_message_contains_all_its_fields(tmp_path):
    analysis = analysed(tmp_path, node=KEEPER)
    assert (
        analysis.holders("/odom", "twist.angular.z", site(analysis, TOTAL))[0] == "self.odom.twist.angular.z"
    )
    assert analysis.holders("/odom", "ranges.3", site(analysis, TOTAL))[0] == "self.odom.ranges[3]"


def test_repair_condition_uses_no_changed_values(tmp_path):
    analysis = analysed(tmp_path, node=KEEPER)
    found = analysis.holders("/odom", "pose.position.y", site(analysis, TOTAL))
    assert "self.scaled" not in found
    assert analysis.holders("/scan", "pose.position.y", site(analysis, TOTAL)) == ()


def test_repair_condition_uses_no_earlier_message(tmp_path):
    analysis = analysed(tmp_path, node=KEEPER)
    place = site(analysis, "self.y = msg.pose.position.y")
    assert analysis.holders("/odom", "pose.position.y", place) == (
        "msg.pose.position.y",
        "self.odom.pose.position.y",
        "keeper.odom.pose.position.y",
    )


def test_overwritten_field_is_not_in_a_repair_condition(tmp_path):
    analysis = analysed(
        tmp_path,
        node="""
        import rospy
        def on(msg):
            msg.linear.x = 0.5 * msg.linear.x
            v = msg.linear.x + msg.linear.y
            out.publish(v)
        out = rospy.Publisher("b", F)
        rospy.Subscriber("a", F, on)
        """,
    )
    place = site(analysis, "v = msg.linear.x + msg.linear.y")
    assert analysis.holders("a", "linear.x", place) == ()
    assert analysis.holders("a", "linear.y", place) == ("msg.linear.y",)
