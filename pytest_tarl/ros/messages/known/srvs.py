"""Service types, as `== package/Name` and the lines of its .srv file."""

BOTH = """
== control_msgs/QueryCalibrationState
---
bool is_calibrated
== control_msgs/QueryTrajectoryState
time time
---
string[] name
float64[] position
float64[] velocity
float64[] acceleration
== pcl_msgs/UpdateFilename
string filename
---
bool success
== gazebo_msgs/GetModelState
string model_name
string relative_entity_name
---
std_msgs/Header header
geometry_msgs/Pose pose
geometry_msgs/Twist twist
bool success
string status_message
== gazebo_msgs/SetModelState
gazebo_msgs/ModelState model_state
---
bool success
string status_message
== gazebo_msgs/SpawnModel
string model_name
string model_xml
string robot_namespace
geometry_msgs/Pose initial_pose
string reference_frame
---
bool success
string status_message
== gazebo_msgs/DeleteModel
string model_name
---
bool success
string status_message
== mavros_msgs/CommandBool
bool value
---
bool success
uint8 result
== mavros_msgs/CommandTOL
float32 min_pitch
float32 yaw
float32 latitude
float32 longitude
float32 altitude
---
bool success
uint8 result
== mavros_msgs/SetMode
uint8 base_mode
string custom_mode
---
bool mode_sent
== nav_msgs/GetMap
---
nav_msgs/OccupancyGrid map
== nav_msgs/GetPlan
geometry_msgs/PoseStamped start
geometry_msgs/PoseStamped goal
float32 tolerance
---
nav_msgs/Path plan
== nav_msgs/LoadMap
string map_url
---
uint8 RESULT_SUCCESS=0
uint8 RESULT_MAP_DOES_NOT_EXIST=1
uint8 RESULT_INVALID_MAP_DATA=2
uint8 RESULT_INVALID_MAP_METADATA=3
uint8 RESULT_UNDEFINED_FAILURE=255
nav_msgs/OccupancyGrid map
uint8 result
== nav_msgs/SetMap
nav_msgs/OccupancyGrid map
geometry_msgs/PoseWithCovarianceStamped initial_pose
---
bool success
== sensor_msgs/SetCameraInfo
sensor_msgs/CameraInfo camera_info
---
bool success
string status_message
== std_srvs/Empty
---
== std_srvs/SetBool
bool data
---
bool success
string message
== std_srvs/Trigger
---
bool success
string message
== tf2_msgs/FrameGraph
---
string frame_yaml
== turtlebot3_msgs/Dqn
uint8 action
bool init
---
float32[] state
float32 reward
bool done
== turtlebot3_msgs/Sound
uint8 value
---
bool success
string message
== topic_tools/MuxAdd
string topic
---
== topic_tools/MuxDelete
string topic
---
== topic_tools/MuxList
---
string[] topics
== topic_tools/MuxSelect
string topic
---
string prev_topic
== topic_tools/DemuxAdd
string topic
---
== topic_tools/DemuxDelete
string topic
---
== topic_tools/DemuxList
---
string[] topics
== topic_tools/DemuxSelect
string topic
---
string prev_topic
== turtlesim/Kill
string name
---
== turtlesim/SetPen
uint8 r
uint8 g
uint8 b
uint8 width
uint8 off
---
== turtlesim/Spawn
float32 x
float32 y
float32 theta
string name
---
string name
== turtlesim/TeleportAbsolute
float32 x
float32 y
float32 theta
---
== turtlesim/TeleportRelative
float32 linear
float32 angular
---
"""

ROS1 = """
== laser_assembler/AssembleScans
time begin
time end
---
sensor_msgs/PointCloud cloud
== laser_assembler/AssembleScans2
time begin
time end
---
sensor_msgs/PointCloud2 cloud
== diagnostic_msgs/SelfTest
---
string id
byte passed
diagnostic_msgs/DiagnosticStatus[] status
== dynamic_reconfigure/Reconfigure
dynamic_reconfigure/Config config
---
dynamic_reconfigure/Config config
== roscpp/Empty
---
== roscpp/GetLoggers
---
roscpp/Logger[] loggers
== roscpp/SetLoggerLevel
string logger
string level
---
== roscpp_tutorials/TwoInts
int64 a
int64 b
---
int64 sum
== rospy_tutorials/AddTwoInts
int64 a
int64 b
---
int64 sum
== rospy_tutorials/BadTwoInts
int64 a
int32 b
---
int32 sum
== beginner_tutorials/AddTwoInts
int64 a
int64 b
---
int64 sum
"""

ROS2 = """
== action_msgs/CancelGoal
GoalInfo goal_info
---
int8 ERROR_NONE=0
int8 ERROR_REJECTED=1
int8 ERROR_UNKNOWN_GOAL_ID=2
int8 ERROR_GOAL_TERMINATED=3
int8 return_code
GoalInfo[] goals_canceling
== composition_interfaces/ListNodes
---
string[] full_node_names
uint64[] unique_ids
== composition_interfaces/LoadNode
string package_name
string plugin_name
string node_name
string node_namespace
uint8 log_level
string[] remap_rules
rcl_interfaces/Parameter[] parameters
rcl_interfaces/Parameter[] extra_arguments
---
bool success
string error_message
string full_node_name
uint64 unique_id
== composition_interfaces/UnloadNode
uint64 unique_id
---
bool success
string error_message
== diagnostic_msgs/SelfTest
---
string id
byte passed
diagnostic_msgs/DiagnosticStatus[] status
== example_interfaces/AddTwoInts
int64 a
int64 b
---
int64 sum
== example_interfaces/SetBool
bool data
---
bool success
string message
== example_interfaces/Trigger
---
bool success
string message
== lifecycle_msgs/ChangeState
Transition transition
---
bool success
== lifecycle_msgs/GetAvailableStates
---
State[] available_states
== lifecycle_msgs/GetAvailableTransitions
---
TransitionDescription[] available_transitions
== lifecycle_msgs/GetState
---
State current_state
== nav2_msgs/ClearCostmapAroundRobot
float32 reset_distance
---
std_msgs/Empty response
== nav2_msgs/ClearCostmapExceptRegion
float32 reset_distance
---
std_msgs/Empty response
== nav2_msgs/ClearEntireCostmap
std_msgs/Empty request
---
std_msgs/Empty response
== nav2_msgs/GetCostmap
nav2_msgs/CostmapMetaData specs
---
nav2_msgs/Costmap map
== nav2_msgs/LoadMap
string map_url
---
uint8 RESULT_SUCCESS=0
uint8 RESULT_MAP_DOES_NOT_EXIST=1
uint8 RESULT_INVALID_MAP_DATA=2
uint8 RESULT_INVALID_MAP_METADATA=3
uint8 RESULT_UNDEFINED_FAILURE=255
nav_msgs/OccupancyGrid map
uint8 result
== nav2_msgs/ManageLifecycleNodes
uint8 STARTUP=0
uint8 PAUSE=1
uint8 RESUME=2
uint8 RESET=3
uint8 SHUTDOWN=4
uint8 command
---
bool success
== nav2_msgs/SaveMap
string map_topic
string map_url
string image_format
string map_mode
float32 free_thresh
float32 occupied_thresh
---
bool result
== rcl_interfaces/DescribeParameters
string[] names
---
ParameterDescriptor[] descriptors
== rcl_interfaces/GetLoggerLevels
string[] names
---
rcl_interfaces/LoggerLevel[] levels
== rcl_interfaces/SetLoggerLevels
rcl_interfaces/LoggerLevel[] levels
---
rcl_interfaces/SetLoggerLevelsResult[] results
== rcl_interfaces/GetParameterTypes
string[] names
---
uint8[] types
== rcl_interfaces/GetParameters
string[] names
---
ParameterValue[] values
== rcl_interfaces/ListParameters
uint64 DEPTH_RECURSIVE=0
string[] prefixes
uint64 depth
---
ListParametersResult result
== rcl_interfaces/SetParameters
Parameter[] parameters
---
SetParametersResult[] results
== rcl_interfaces/SetParametersAtomically
Parameter[] parameters
---
SetParametersResult result
"""
