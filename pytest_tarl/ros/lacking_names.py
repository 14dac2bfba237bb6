"""Public names of ROS modules that the stand-ins lack, so that errors can tell them from misspelled names.

The list covers every module whose source was compared: rospy 1.15, rclpy 9.1, tf 1.13, tf2 0.7, actionlib 1.14, and all
other packages in the version of Debian 12. Names that a module merely imports from the standard library are left out.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

LACKING: Final[Mapping[str, str]] = {  # module → names
    "rospy": "MasterProxy parse_rosrpc_uri",
    "rospy.exceptions": "",
    "rospy.rostime": "get_rostime_cond",
    "rospy.timer": "",
    "rospy.numpy_msg": "",
    "genpy": "",
    "genpy.rostime": "",
    "genpy.message": "RosMsgUnicodeErrors check_type is_simple isstring long reload",
    "genpy.dynamic": "MsgContext MsgGenerationException StringIO msg_generator",
    "rosbag": "rosbagmain",
    "rosbag.bag": (
        "AES BagMessageWithConnectionHeader ComparableMixin ROSBagEncryptException "
        "ROSBagEncryptNotSupportedException StringIO found_lz4 get_random_bytes"
    ),
    "roslib": "is_interactive set_interactive",
    "roslib.message": "check_type",
    "rospy.client": "Lock TIMEOUT_READY load_command_line_node_params",
    "rospy.core": (
        "LoggingIdentical LoggingOnce LoggingThrottle MASTER_NAME NullHandler ParameterInvalid ROSRPC is_topic md5 "
        "parse_rosrpc_uri partial register_signals set_initialized set_node_uri xmlrpcapi"
    ),
    "rospy.msg": "args_kwds_to_message deserialize_messages serialize_message",
    "rospy.names": (
        "ANYTYPE GLOBALNS ParameterInvalid REMAP SEP SERVICE_ANYTYPE TOPIC_ANYTYPE canonicalize_name get_mappings "
        "get_resolved_mappings global_name initialize_mappings isstring reload_mappings "
        "resolve_name_without_node_name scoped_name valid_name valid_name_validator_resolved "
        "valid_name_validator_unresolved"
    ),
    "rospy.service": ("Registration ServiceManager get_registration_listeners logger set_service_manager"),
    "rospy.topics": (
        "Message Poller QueuedConnection Registration StringIO SubscriberStatisticsLogger TransportTerminated "
        "args_kwds_to_message chain get_registration_listeners get_tcpros_handler get_topic_manager isstring "
        "python3 select serialize_message set_topic_manager"
    ),
    "rclpy": "InitContextManager TracebackType",
    "rclpy.action": (
        "get_action_client_names_and_types_by_node get_action_names_and_types "
        "get_action_server_names_and_types_by_node"
    ),
    "rclpy.action.client": (
        "Action CallbackGroup ClientGoalHandleDict ClientGoalHandleDictFeedbackT ClientGoalHandleDictResultT "
        "FeedbackMessage FeedbackT GetResultServiceResponse GoalT Node NumberOfEntities ResultT SendGoalKWargs "
        "SendGoalServiceResponse T TracebackType Waitable await_or_execute"
    ),
    "rclpy.action.server": (
        "Action CallbackGroup Enum FeedbackMessage FeedbackT GetResultServiceRequest GetResultServiceResponse "
        "GoalEvent GoalT Node NumberOfEntities ResultT SendGoalServiceRequest ServerGoalHandleDict "
        "ServerGoalHandleDictGoalT TracebackType Waitable await_or_execute"
    ),
    "rclpy.clock_type": "",
    "rclpy.constants": "",
    "rclpy.context": ("MethodType Node TracebackType g_logging_configure_lock g_logging_ref_count ismethod"),
    "rclpy.event_handler": (
        "EventHandler EventHandlerData NumberOfEntities QoSEventHandler QoSPublisherEventType "
        "QoSSubscriptionEventType TracebackType Waitable deprecated qos_policy_name_from_kind"
    ),
    "rclpy.guard_condition": "",
    "rclpy.lifecycle": "",
    "rclpy.lifecycle.node": (
        "CallbackNames Context CreateLifecyclePublisherArgs LifecycleNodeArgs MsgT Parameter "
        "PublisherEventCallbacks QoSOverridingOptions"
    ),
    "rclpy.lifecycle.publisher": "LifecyclePublisherArgs LifecyclePublisherKWArgs MsgT",
    "rclpy.lifecycle.managed_entity": "",
    "rclpy.qos_event": "",
    "rclpy.qos_overriding_options": "Node QoSProfileAttributes",
    "rclpy.signals": "Context GuardCondition SignalHandlerGuardCondition",
    "rclpy.topic_endpoint_info": (
        "QoSHistoryPolicy QoSPresetProfiles QoSProfile TypeHash TypeHashDictionary"
    ),
    "rclpy.wait_for_message": ("MsgT Node QoSProfile SignalHandlerGuardCondition timeout_sec_to_nsec"),
    "rclpy.callback_groups": ("Client Entity GuardCondition Lock Service Subscription Timer Waitable"),
    "rclpy.client": "Srv SrvRequestT SrvResponseT TracebackType",
    "rclpy.clock": "JumpHandlePreCallbackType TimeJump TimeJumpDictionary TracebackType",
    "rclpy.duration": "",
    "rclpy.exceptions": "",
    "rclpy.executors": (
        "Condition EntityT ExitStack Lock Msg Node NumberOfEntities RLock SignalHandlerGuardCondition T "
        "ThreadPoolExecutor TimeoutObject TracebackType Waitable YieldedCallback await_or_execute partial"
    ),
    "rclpy.logging": "Path get_logging_directory",
    "rclpy.impl": "",
    "rclpy.impl.logging_severity": "",
    "rclpy.impl.rcutils_logger": (
        "CallerId Clock FrameType LoggingArgs LoggingFilter LoggingFilterArgs LoggingFilterParams Once OnceContext "
        "RcutilsLoggerContext SkipFirst SkipFirstContext SupportedFiltersKeys Throttle ThrottleContext deprecated "
        "get_filters_from_kwargs supported_filters"
    ),
    "rclpy.node": (
        "AllowableParameterValue AllowableParameterValueT ContentFilterOptions HIDDEN_NODE_PREFIX LoggingService "
        "MsgT MsgType NodeNameNonExistentError PARAMETER_SEPARATOR_STRING ParameterService S_TO_NS Srv SrvRequestT "
        "SrvResponseT SrvType SrvTypeRequest SrvTypeResponse TimeSource TracebackType TypeDescriptionService "
        "Waitable deprecated"
    ),
    "rclpy.parameter": "AllowableParameterValue AllowableParameterValueT",
    "rclpy.publisher": "EventHandler MsgT TracebackType",
    "rclpy.qos": (
        "DeadlineBestAvailable LivelinessLeaseDurationeBestAvailable QoSPolicyEnum QoSPolicyKind "
        "qos_policy_name_from_kind"
    ),
    "rclpy.service": "Srv SrvRequestT SrvResponseT TracebackType",
    "rclpy.service_introspection": "",
    "rclpy.subscription": "ContentFilterOptions Enum MsgT TracebackType",
    "rclpy.task": "Enum Executor FutureState T",
    "rclpy.time": "",
    "rclpy.timer": "TracebackType",
    "rclpy.utilities": "S_TO_NS g_context_lock g_default_context get_available_rmw_implementations",
    "image_geometry": "",
    "image_geometry.cameramodels": "mkmat",
    "interactive_markers": "",
    "interactive_markers.interactive_marker_server": "Header Lock MarkerContext UpdateContext",
    "interactive_markers.menu_handler": "EntryContext",
    "message_filters": "reduce",
    "actionlib": "",
    "actionlib.action_client": (
        "CommStateMachine GoalManager INVALID_TRANSITION NO_TRANSITION g_goal_id get_name_of_constant"
    ),
    "actionlib.action_server": "HandleTrackerDeleter StatusTracker nop_cb",
    "actionlib.exceptions": "",
    "actionlib.goal_id_generator": "s_goalcount s_goalcount_lock",
    "actionlib.server_goal_handle": "",
    "actionlib.simple_action_client": "get_name_of_constant",
    "actionlib.simple_action_server": "nop_cb",
    "dynamic_reconfigure": "",
    "dynamic_reconfigure.client": (
        "ConfigDescrMsg ConfigMsg DynamicReconfigureCallbackException DynamicReconfigureParameterException "
        "ReconfigureSrv ServiceException decode_description extract_params"
    ),
    "dynamic_reconfigure.encoding": (
        "BoolParameter ConfigDescrMsg ConfigMsg DoubleParameter GroupMsg GroupState IntParameter ParamDescription "
        "StrParameter decode_description encode_description encode_groups extract_params get_parents get_tree "
        "group_dict initial_config"
    ),
    "dynamic_reconfigure.server": (
        "ConfigDescrMsg ConfigMsg DynamicReconfigureCallbackException ReconfigureSrv encode_description "
        "extract_params get_tree initial_config"
    ),
    "diagnostic_updater": "",
    "laser_geometry": "",
    "laser_geometry.laser_geometry": "PointCloud2",
    "tf2_sensor_msgs": "",
    "tf2_sensor_msgs.tf2_sensor_msgs": ("PointCloud2 from_msg_msg read_points to_msg_msg transform_to_kdl"),
    "angles": (
        "fabs fmod pi shortest_angular_distance_with_large_limits shortest_angular_distance_with_limits"
    ),
    "ament_index_python": (
        "InvalidResourceNameError InvalidResourceTypeNameError RESOURCE_INDEX_SUBFOLDER get_resource "
        "get_resource_types get_resources get_search_paths has_resource"
    ),
    "ament_index_python.packages": "get_resource get_resources get_search_paths",
    "rospkg": (
        "InvalidManifest MANIFEST_FILE Manifest RosStack STACK_FILE expand_to_packages get_etc_ros_dir "
        "get_ros_paths get_ros_root get_stack_version_by_dir get_test_results_dir list_by_path parse_manifest_file"
    ),
    "rospkg.common": "MANIFEST_FILE PACKAGE_FILE ROS_STACK STACK_FILE",
    "rospkg.environment": (
        "ROS_ETC_DIR ROS_HOME ROS_LOG_DIR ROS_PACKAGE_PATH ROS_ROOT ROS_TEST_RESULTS_DIR get_etc_ros_dir "
        "get_ros_paths get_ros_root get_test_results_dir"
    ),
    "roslib.packages": (
        "MANIFEST_FILE MultipleNodesException PACKAGE_FILE PIPE Popen ROSPkgException ROS_PACKAGE_PATH ROS_ROOT "
        "SRC_DIR catkin_find get_pkg_subdir list_pkgs_by_path resource_file"
    ),
    "tf": "",
    "tf.broadcaster": "",
    "tf.listener": "strip_leading_slash xyz_to_mat44 xyzw_to_mat44",
    "tf2_geometry_msgs": "",
    "tf2_py": "",
    "tf2_ros": "",
    "tf2_ros.buffer": "DEFAULT_CAN_TRANSFORM_POLLING_SCALE",
    "tf2_ros.buffer_interface": ("ConvertRegistration NotImplementedException Stamped convert deepcopy"),
    "tf2_ros.static_transform_broadcaster": "",
    "tf2_ros.transform_broadcaster": "",
    "tf2_ros.transform_listener": "",
    "cv_bridge": "cvtColorForDisplay",
    "cv_bridge.core": "",
    "cv_bridge.boost": "",
    "tf.transformations": (
        "Arcball arcball_constrain_to_axis arcball_map_to_sphere arcball_nearest_axis projection_from_matrix "
        "shear_from_matrix"
    ),
    "rclpy.expand_topic_name": "",
    "rclpy.experimental": "",
    "rclpy.experimental.events_executor": "",
    "rclpy.parameter_event_handler": "Lock chain",
    "rclpy.serialization": "Msg MsgT check_for_type_support",
    "rclpy.parameter_client": "",
    "rclpy.topic_or_service_is_hidden": "",
    "rclpy.type_support": (
        "Action ActionT CommonMsgSrvMetaClass EventMessage FeedbackMessage FeedbackT GetResultService "
        "GetResultServiceRequest GetResultServiceResponse GoalT Msg MsgMetaClass MsgT ProtocolType PyCapsule "
        "ResultT SendGoalService SendGoalServiceRequest SendGoalServiceResponse ServiceEventInfo Srv SrvRequestT "
        "SrvResponseT SrvT Time UUID"
    ),
    "rclpy.validate_full_topic_name": "",
    "rclpy.validate_namespace": "",
    "rclpy.validate_node_name": "",
    "rclpy.validate_parameter_name": "",
    "rclpy.validate_topic_name": "",
    "rosgraph": "ROS_HOSTNAME ROS_IP ROS_IPV6 ROS_MASTER_URI ROS_NAMESPACE",
    "rosgraph.masterapi": (
        "Failure ROSMasterException ServerProxy is_online make_caller_id parse_http_host_and_port"
    ),
    "rosgraph.names": (
        "BASE_NAME_LEGAL_CHARS_P MSG_EXT NAME_LEGAL_CHARS_P REMAP_PATTERN ROS_NAMESPACE SRV_EXT is_legal_remap "
        "isstring"
    ),
    "rosnode": (
        "CONNECTION_PATTERN ID NAME OptionParser ServerProxy cleanup_master_blacklist cleanup_master_whitelist "
        "get_api_uri get_machines_by_nodes get_node_connection_info_description get_node_info_description "
        "get_nodes_by_machine lookup_uri rosnode_cleanup rosnode_debugnode rosnode_info rosnode_listnodes "
        "rosnode_ping_all rosnodemain"
    ),
    "rosparam": (
        "Binary GLOBALNS NAME NS OptionParser construct_angle_degrees construct_angle_radians "
        "construct_yaml_binary dump_params get_param_server get_ros_namespace make_caller_id make_global_ns "
        "ns_join pattern print_params represent_foo represent_xml_binary script_resolve_name set_param_raw "
        "yamlmain"
    ),
    "rosservice": (
        "BufferType NAME OptionParser get_service_args get_service_headers get_service_uri has_service_args "
        "rosservice_find rosservicemain"
    ),
    "rostopic": (
        "CallbackEcho Fault NAME ROSTopicBandwidth ROSTopicDelay SUBSCRIBER_TIMEOUT argv_publish "
        "create_field_filter create_publisher create_value_transform file_yaml_arg find_by_type get_api "
        "get_info_text get_topic_list itemgetter long msgevalgen param_publish param_publish_once publish_message "
        "rostopicmain stdin_publish stdin_yaml_arg urlparse wait_for_subscriber"
    ),
    "tf2_ros.buffer_client": "",
    "topic_tools": "MetaLazyTransport",
    "tf_conversions": "",
    "tf_conversions.posemath": "Point Pose Quaternion fromCameraParams transformations",
    "tf2_kdl": "",
}
