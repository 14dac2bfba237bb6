"""Libraries of the ROS 1 tools: rosgraph, rosnode, rostopic, rosservice, rosparam, ros_numpy and others."""

from __future__ import annotations

import numpy as np
import pytest

from pytest_tarl.ros import message_type
from tests.plugin.ros.conftest import Start

TALKER = """
    import rospy
    from std_msgs.msg import Float64
    from std_srvs.srv import SetBool, SetBoolResponse
    rospy.init_node("talker")
    pub = rospy.Publisher("speed", Float64, queue_size=1)
    rospy.Subscriber("goal", Float64, lambda message: None)
    rospy.Service("stop", SetBool, lambda request: SetBoolResponse(request.data, "heard"))
    rospy.spin()
"""


def test_the_master_lists_publishers_subscribers_and_services(start: Start) -> None:
    ros = start(TALKER)
    start(
        """
        import rosgraph, rospy
        rospy.init_node("asker")
        master = rosgraph.Master("/asker")
        online = rosgraph.is_master_online(), master.is_online()
        published, subscribed, served = master.getSystemState()
        topics, types = master.getPublishedTopics("/"), dict(master.getTopicTypes())
        code, _, names = rospy.get_master().getPublishedTopics("")
        refused = rospy.get_master().lookupNode("/nobody")
        master.setParam("gain", 2.5)
        gain = rospy.get_param("/gain"), master.getParam("/gain"), master.hasParam("nothing")
        found = master.searchParam("gain"), master.searchParam("nothing")
        try:
            master.lookupService("/nothing")
        except rosgraph.MasterException as error:
            said = str(error)
    """,
        ros=ros,
    )
    told = ros.namespace
    assert told["online"] == (True, True)
    assert told["published"] == [["/speed", ["/talker"]]]
    assert told["subscribed"] == [["/goal", ["/talker"]]]
    assert told["served"] == [["/stop", ["/talker"]]]
    assert told["topics"] == told["names"] == [["/speed", "std_msgs/Float64"]]
    assert told["types"] == {"/speed": "std_msgs/Float64", "/goal": "std_msgs/Float64"}
    assert (told["code"], told["refused"][0]) == (1, -1)
    assert told["gain"] == (2.5, 2.5, False)
    assert told["found"] == ("/gain", None)
    assert told["said"] == "no provider"


def test_nodes_topics_and_services_are_found_by_name(start: Start) -> None:
    ros = start(TALKER)
    start(
        """
        import rosnode, rospy, rosservice, rostopic
        rospy.init_node("asker")
        nodes = rosnode.get_node_names(), rosnode.get_node_names("/nowhere")
        pinged = rosnode.rosnode_ping("/talker"), rosnode.rosnode_ping("/nobody", max_count=1)
        kind, name, field = rostopic.get_topic_type("/speed/data")
        made, _, _ = rostopic.get_topic_class("speed")
        value = field(made(3.0))
        unknown = rostopic.get_topic_type("/nothing")
        services = rosservice.get_service_list(), rosservice.get_service_type("/stop")
        served = rosservice.get_service_node("stop")
        answer = rosservice.call_service("/stop", [True])[1].success
        killed = rosnode.kill_nodes(["/talker", "/nobody"])
        rospy.sleep(0.1)
        left = rosnode.get_node_names()
    """,
        ros=ros,
    )
    ros.step(0.2)
    told = ros.namespace
    assert told["nodes"] == (["/asker", "/talker"], [])
    assert told["pinged"] == (True, False)
    assert (told["kind"], told["name"], told["value"]) == ("std_msgs/Float64", "/speed", 3.0)
    assert told["unknown"] == (None, None, None)
    assert told["services"] == (["/stop"], "std_srvs/SetBool")
    assert told["served"] == "/talker"
    assert told["answer"] is True
    assert told["killed"] == (["/talker"], ["/nobody"])
    assert told["left"] == ["/asker"]


def test_a_blocking_topic_query_waits_for_a_publisher(start: Start) -> None:
    ros = start("""
        import rospy, rostopic
        rospy.init_node("asker")
        kind, _, _ = rostopic.get_topic_type("/speed", blocking=True)
        when = rospy.get_time()
    """)
    asker = ros.namespace
    ros.step(1.0)
    start(TALKER, ros=ros)
    ros.step(1.0)
    assert asker["kind"] == "std_msgs/Float64"
    assert 1.0 <= asker["when"] <= 1.1


def test_parameters_are_read_from_files(start: Start, tmp_path: object) -> None:
    ros = start(f"""
        import rosparam, rospy
        rospy.init_node("asker")
        path = "{tmp_path}/gains.yaml"
        with open(path, "w") as file:
            file.write("kp: 2.5\\nlimits: {{low: -1, high: 1}}\\n")
        for values, namespace in rosparam.load_file(path, default_namespace="/arm"):
            rosparam.upload_params(namespace, values)
        got = rospy.get_param("/arm/kp"), rosparam.get_param("/arm/limits")
        rosparam.set_param("/arm/kp", "4")
        names = rosparam.list_params("/arm"), rospy.get_param("/arm/kp")
        said = []
        for call in (lambda: rosparam.load_file("nothing.yaml"), lambda: rosparam.get_param("/nothing"),
                     lambda: rosparam.load_str("a: [", "broken.yaml")):
            try:
                call()
            except rosparam.RosParamException as error:
                said.append(str(error).split("\\n")[0])
    """)
    told = ros.namespace
    assert told["got"] == (2.5, {"low": -1, "high": 1})
    assert told["names"] == (["/arm/kp", "/arm/limits/high", "/arm/limits/low"], 4)
    assert told["said"][:2] == ["file [nothing.yaml] does not exist", "Parameter [/nothing] is not set"]
    assert told["said"][2].startswith("Invalid YAML in file [broken.yaml]")


def test_a_buffer_server_answers_lookups_of_other_nodes(start: Start) -> None:
    ros = start("""
        import rospy, tf2_ros
        from geometry_msgs.msg import TransformStamped
        rospy.init_node("frames")
        buffer = tf2_ros.Buffer()
        listener = tf2_ros.TransformListener(buffer)
        server = tf2_ros.BufferServer(buffer, "tf2_buffer_server")
        sent = TransformStamped()
        sent.header.frame_id, sent.child_frame_id = "map", "base"
        sent.transform.translation.x, sent.transform.rotation.w = 2.0, 1.0
        tf2_ros.StaticTransformBroadcaster().sendTransform(sent)
        rospy.spin()
    """)
    start(
        """
        import rospy, tf2_ros
        rospy.init_node("asker")
        nobody = tf2_ros.BufferClient("nobody").wait_for_server(rospy.Duration(0.1))
        client = tf2_ros.BufferClient("tf2_buffer_server")
        there = client.wait_for_server(rospy.Duration(1))
        found = client.lookup_transform("map", "base", rospy.Time(0), rospy.Duration(1)).transform.translation.x
        can = client.can_transform("map", "moon", rospy.Time(0), rospy.Duration(0.1))
        try:
            impatient = tf2_ros.BufferClient("nobody", timeout_padding=rospy.Duration(0.1))
            impatient.lookup_transform("map", "base", rospy.Time(0))
        except tf2_ros.TimeoutException as error:
            said = str(error)
    """,
        ros=ros,
    )
    ros.step(1.0)
    told = ros.namespace
    assert (told["nobody"], told["there"], told["found"], told["can"]) == (False, True, 2.0, False)
    assert "BufferServer /nobody timed out" in told["said"]


def test_parameters_of_another_node_are_read_and_set(start: Start) -> None:
    ros = start("""
        import rclpy
        rclpy.init()
        node = rclpy.create_node("arm")
        node.declare_parameter("kp", 2.5)
        try:
            rclpy.spin(node)
        except rclpy.executors.ExternalShutdownException:
            pass
    """)
    start(
        """
        import rclpy
        from rclpy.parameter import Parameter
        from rclpy.parameter_client import AsyncParameterClient
        rclpy.init()
        node = rclpy.create_node("asker")
        client = AsyncParameterClient(node, "arm")
        ready = client.wait_for_services(timeout_sec=1.0), client.services_are_ready()
        called = []
        def ask(future):
            rclpy.spin_until_future_complete(node, future)
            return future.result()
        listed = "kp" in ask(client.list_parameters(callback=called.append)).result.names
        before = ask(client.get_parameters(["kp"])).values[0].double_value
        changed = ask(client.set_parameters([Parameter("kp", value=4.0)])).results[0].successful
        atomically = ask(client.set_parameters_atomically([Parameter("kp", value=5.0)])).result.successful
        after = ask(client.get_parameters(["kp"])).values[0].double_value
        kinds = list(ask(client.get_parameter_types(["kp"])).types)
        events = []
        client.on_parameter_event(events.append)
        ask(client.set_parameters([Parameter("kp", value=6.0)]))
        rclpy.spin_once(node, timeout_sec=0.1)
        described = ask(client.describe_parameters(["kp"])).descriptors[0].name
        nobody = AsyncParameterClient(node, "nobody").wait_for_services(timeout_sec=0.1)
    """,
        ros=ros,
    )
    ros.step(1.0)
    told = ros.namespace
    assert told["ready"] == (True, True)
    assert (told["listed"], told["before"], told["changed"], told["atomically"]) == (True, 2.5, True, True)
    assert (told["after"], told["kinds"], told["described"], told["nobody"]) == (5.0, [3], "kp", False)
    assert len(told["called"]) == 1
    assert [event.changed_parameters[0].value.double_value for event in told["events"]] == [6.0]


@pytest.mark.parametrize("library", ["rospy", "rclpy"])
def test_ros_numpy_converts_messages_to_arrays_and_back(start: Start, library: str) -> None:
    ros = start(f"""
        import {library}
        import numpy as np
        import ros_numpy
        from geometry_msgs.msg import Point, Pose, Quaternion, Transform, Vector3
        from nav_msgs.msg import OccupancyGrid
        from sensor_msgs.msg import Image, PointCloud2
        point = ros_numpy.numpify(Point(x=1.0, y=2.0, z=3.0), hom=True)
        pose = Pose(position=Point(x=1.0, y=2.0, z=3.0), orientation=Quaternion(x=0.0, y=0.0, z=1.0, w=0.0))
        matrix = ros_numpy.numpify(pose)
        again = ros_numpy.msgify(Pose, matrix)
        moved = ros_numpy.msgify(Transform, matrix).translation.y
        vector = ros_numpy.msgify(Vector3, np.array([1, 2, 3]))
        grid = ros_numpy.msgify(OccupancyGrid, np.array([[0, -1], [100, 50]], dtype=np.int8))
        cells = ros_numpy.numpify(grid)
        image = ros_numpy.numpify(ros_numpy.msgify(Image, np.full((2, 3, 3), 7, dtype=np.uint8), encoding="rgb8"))
        kind = [("x", "f4"), ("y", "f4"), ("z", "f4"), ("rgb", "u4")]
        points = np.array([(1, 2, 3, 0x0A0B0C), (4, np.nan, 6, 0)], dtype=kind)
        cloud = ros_numpy.msgify(PointCloud2, points, frame_id="lidar")
        xyz = ros_numpy.point_cloud2.pointcloud2_to_xyz_array(cloud)
        colours = ros_numpy.point_cloud2.split_rgb_field(ros_numpy.numpify(cloud))
        try:
            ros_numpy.numpify(cloud.header)
        except ValueError as error:
            said = str(error)
    """)
    told = ros.namespace
    assert told["point"].tolist() == [1.0, 2.0, 3.0, 1.0]
    assert told["matrix"] @ [1, 0, 0, 1] == pytest.approx([0, 2, 3, 1])
    assert (told["again"].position, told["moved"], told["vector"].z) == (told["pose"].position, 2.0, 3.0)
    assert abs(told["again"].orientation.z) == pytest.approx(1.0)
    assert told["cells"].mask.tolist() == [[False, True], [False, False]]
    assert told["image"].shape == (2, 3, 3)
    assert np.array_equal(told["xyz"], [[1, 2, 3]])
    assert [int(told["colours"][0][one]) for one in "rgb"] == [10, 11, 12]
    assert (told["cloud"].header.frame_id, told["cloud"].is_dense) == ("lidar", False)
    assert "Unable to convert message Header" in told["said"]
    assert message_type("geometry_msgs/Point") is not None
