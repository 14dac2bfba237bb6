"""Action types, as `== package/Name` and the lines of its .action file."""

_FIBONACCI = """int32 order
---
int32[] sequence
---
int32[] {feedback}
"""
_TRAJECTORY = """trajectory_msgs/JointTrajectory trajectory
control_msgs/JointTolerance[] path_tolerance
control_msgs/JointTolerance[] goal_tolerance
duration goal_time_tolerance
---
int32 SUCCESSFUL=0
int32 INVALID_GOAL=-1
int32 INVALID_JOINTS=-2
int32 OLD_HEADER_TIMESTAMP=-3
int32 PATH_TOLERANCE_VIOLATED=-4
int32 GOAL_TOLERANCE_VIOLATED=-5
int32 error_code
string error_string
---
std_msgs/Header header
string[] joint_names
trajectory_msgs/JointTrajectoryPoint desired
trajectory_msgs/JointTrajectoryPoint actual
trajectory_msgs/JointTrajectoryPoint error
"""

BOTH = f"""
== control_msgs/PointHead
geometry_msgs/PointStamped target
geometry_msgs/Vector3 pointing_axis
string pointing_frame
duration min_duration
float64 max_velocity
---
---
float64 pointing_angle_error
== control_msgs/SingleJointPosition
float64 position
duration min_duration
float64 max_velocity
---
---
std_msgs/Header header
float64 position
float64 velocity
float64 error
== control_msgs/JointTrajectory
trajectory_msgs/JointTrajectory trajectory
---
---
== control_msgs/FollowJointTrajectory
{_TRAJECTORY}
== control_msgs/GripperCommand
control_msgs/GripperCommand command
---
float64 position
float64 effort
bool stalled
bool reached_goal
---
float64 position
float64 effort
bool stalled
bool reached_goal
== tf2_msgs/LookupTransform
string target_frame
string source_frame
time source_time
duration timeout
time target_time
string fixed_frame
bool advanced
---
geometry_msgs/TransformStamped transform
TF2Error error
---
== turtlebot3_msgs/Patrol
geometry_msgs/Vector3 goal
---
string result
---
string state
"""

ROS1 = f"""
== pr2_controllers_msgs/JointTrajectory
trajectory_msgs/JointTrajectory trajectory
---
---
== pr2_controllers_msgs/PointHead
geometry_msgs/PointStamped target
geometry_msgs/Vector3 pointing_axis
string pointing_frame
duration min_duration
float64 max_velocity
---
---
float64 pointing_angle_error
== pr2_controllers_msgs/Pr2GripperCommand
pr2_controllers_msgs/Pr2GripperCommand command
---
float64 position
float64 effort
bool stalled
bool reached_goal
---
float64 position
float64 effort
bool stalled
bool reached_goal
== pr2_controllers_msgs/SingleJointPosition
float64 position
duration min_duration
float64 max_velocity
---
---
std_msgs/Header header
float64 position
float64 velocity
float64 error
== actionlib_tutorials/Fibonacci
{_FIBONACCI.format(feedback="sequence")}
== move_base_msgs/MoveBase
geometry_msgs/PoseStamped target_pose
---
---
geometry_msgs/PoseStamped base_position
== turtle_actionlib/Shape
int32 edges
float32 radius
---
float32 interior_angle
float32 apothem
---
"""

ROS2 = f"""
== action_tutorials_interfaces/Fibonacci
{_FIBONACCI.format(feedback="partial_sequence")}
== custom_action_interfaces/Fibonacci
{_FIBONACCI.format(feedback="partial_sequence")}
== example_interfaces/Fibonacci
{_FIBONACCI.format(feedback="sequence")}
== irobot_create_msgs/Dock
---
bool is_docked
---
bool sees_dock
== irobot_create_msgs/Undock
---
bool is_docked
---
== nav2_msgs/AssistedTeleop
duration time_allowance
---
duration total_elapsed_time
uint16 error_code
string error_msg
---
duration current_teleop_duration
== nav2_msgs/BackUp
geometry_msgs/Point target
float32 speed
duration time_allowance
---
duration total_elapsed_time
uint16 error_code
string error_msg
---
float32 distance_traveled
== nav2_msgs/ComputePathThroughPoses
geometry_msgs/PoseStamped[] goals
geometry_msgs/PoseStamped start
string planner_id
bool use_start
---
nav_msgs/Path path
duration planning_time
uint16 error_code
string error_msg
---
== nav2_msgs/ComputePathToPose
geometry_msgs/PoseStamped goal
geometry_msgs/PoseStamped start
string planner_id
bool use_start
---
nav_msgs/Path path
duration planning_time
uint16 error_code
string error_msg
---
== nav2_msgs/DriveOnHeading
geometry_msgs/Point target
float32 speed
duration time_allowance
---
duration total_elapsed_time
uint16 error_code
string error_msg
---
float32 distance_traveled
== nav2_msgs/FollowPath
nav_msgs/Path path
string controller_id
string goal_checker_id
---
std_msgs/Empty result
uint16 error_code
string error_msg
---
float32 distance_to_goal
float32 speed
== nav2_msgs/FollowWaypoints
geometry_msgs/PoseStamped[] poses
---
int32[] missed_waypoints
uint16 error_code
string error_msg
---
uint32 current_waypoint
== nav2_msgs/NavigateThroughPoses
geometry_msgs/PoseStamped[] poses
string behavior_tree
---
uint16 error_code
string error_msg
---
geometry_msgs/PoseStamped current_pose
duration navigation_time
duration estimated_time_remaining
int16 number_of_recoveries
float32 distance_remaining
int16 number_of_poses_remaining
== nav2_msgs/NavigateToPose
geometry_msgs/PoseStamped pose
string behavior_tree
---
uint16 error_code
string error_msg
---
geometry_msgs/PoseStamped current_pose
duration navigation_time
duration estimated_time_remaining
int16 number_of_recoveries
float32 distance_remaining
== nav2_msgs/SmoothPath
nav_msgs/Path path
string smoother_id
duration max_smoothing_duration
bool check_for_collisions
---
nav_msgs/Path path
duration smoothing_duration
bool was_completed
uint16 error_code
string error_msg
---
== nav2_msgs/Spin
float32 target_yaw
duration time_allowance
---
duration total_elapsed_time
uint16 error_code
string error_msg
---
float32 angular_distance_traveled
== nav2_msgs/Wait
duration time
---
duration total_elapsed_time
uint16 error_code
string error_msg
---
duration time_left
== turtlesim/RotateAbsolute
float32 theta
---
float32 delta
---
float32 remaining
"""
