"""Types of simulators, flight controllers and bases, in the form of `msgs`, `srvs` and `actions`."""

MSGS = """
== can_msgs/Frame
std_msgs/Header header
uint32 id
bool is_rtr
bool is_extended
bool is_error
uint8 dlc
uint8[8] data
== gazebo_msgs/ODEPhysics
bool auto_disable_bodies
uint32 sor_pgs_precon_iters
uint32 sor_pgs_iters
float64 sor_pgs_w
float64 sor_pgs_rms_error_tol
float64 contact_surface_layer
float64 contact_max_correcting_vel
float64 cfm
float64 erp
uint32 max_contacts
== mavros_msgs/AttitudeTarget
std_msgs/Header header
uint8 type_mask
uint8 IGNORE_ROLL_RATE=1
uint8 IGNORE_PITCH_RATE=2
uint8 IGNORE_YAW_RATE=4
uint8 IGNORE_THRUST=64
uint8 IGNORE_ATTITUDE=128
geometry_msgs/Quaternion orientation
geometry_msgs/Vector3 body_rate
float32 thrust
== mavros_msgs/OverrideRCIn
uint16 CHAN_RELEASE=0
uint16 CHAN_NOCHANGE=65535
uint16[18] channels
== mavros_msgs/ParamValue
int64 integer
float64 real
== mavros_msgs/RCIn
std_msgs/Header header
uint8 rssi
uint16[] channels
== mavros_msgs/RCOut
std_msgs/Header header
uint16[] channels
== mavros_msgs/VFR_HUD
std_msgs/Header header
float32 airspeed
float32 groundspeed
int16 heading
float32 throttle
float32 altitude
float32 climb
== nmea_msgs/Sentence
std_msgs/Header header
string sentence
== people_msgs/Person
string name
geometry_msgs/Point position
geometry_msgs/Point velocity
float64 reliability
string[] tagnames
string[] tags
== people_msgs/People
std_msgs/Header header
people_msgs/Person[] people
== sound_play/SoundRequest
int8 BACKINGUP=1
int8 NEEDS_UNPLUGGING=2
int8 NEEDS_PLUGGING=3
int8 NEEDS_UNPLUGGING_BADLY=4
int8 NEEDS_PLUGGING_BADLY=5
int8 ALL=-1
int8 PLAY_FILE=-2
int8 SAY=-3
int8 sound
int8 PLAY_STOP=0
int8 PLAY_ONCE=1
int8 PLAY_START=2
int8 command
float32 volume
string arg
string arg2
"""

MSGS_ROS1 = """
== pr2_controllers_msgs/Pr2GripperCommand
float64 position
float64 max_effort
== ar_track_alvar_msgs/AlvarMarker
std_msgs/Header header
uint32 id
uint32 confidence
geometry_msgs/PoseStamped pose
== ar_track_alvar_msgs/AlvarMarkers
std_msgs/Header header
AlvarMarker[] markers
== controller_manager_msgs/HardwareInterfaceResources
string hardware_interface
string[] resources
== controller_manager_msgs/ControllerState
string name
string state
string type
HardwareInterfaceResources[] claimed_resources
== darknet_ros_msgs/BoundingBox
float64 probability
int64 xmin
int64 ymin
int64 xmax
int64 ymax
int16 id
string Class
== darknet_ros_msgs/BoundingBoxes
std_msgs/Header header
std_msgs/Header image_header
BoundingBox[] bounding_boxes
== kobuki_msgs/BumperEvent
uint8 LEFT=0
uint8 CENTER=1
uint8 RIGHT=2
uint8 RELEASED=0
uint8 PRESSED=1
uint8 bumper
uint8 state
== kobuki_msgs/ButtonEvent
uint8 Button0=0
uint8 Button1=1
uint8 Button2=2
uint8 RELEASED=0
uint8 PRESSED=1
uint8 button
uint8 state
== kobuki_msgs/CliffEvent
uint8 LEFT=0
uint8 CENTER=1
uint8 RIGHT=2
uint8 FLOOR=0
uint8 CLIFF=1
uint8 sensor
uint8 state
uint16 bottom
== kobuki_msgs/Led
uint8 BLACK=0
uint8 GREEN=1
uint8 ORANGE=2
uint8 RED=3
uint8 value
== kobuki_msgs/Sound
uint8 ON=0
uint8 OFF=1
uint8 RECHARGE=2
uint8 BUTTON=3
uint8 ERROR=4
uint8 CLEANINGSTART=5
uint8 CLEANINGEND=6
uint8 value
== kobuki_msgs/WheelDropEvent
uint8 LEFT=0
uint8 RIGHT=1
uint8 RAISED=0
uint8 DROPPED=1
uint8 wheel
uint8 state
== smach_msgs/SmachContainerInitialStatusCmd
string path
string[] initial_states
string local_data
== smach_msgs/SmachContainerStatus
std_msgs/Header header
string path
string[] initial_states
string[] active_states
string local_data
string info
== smach_msgs/SmachContainerStructure
std_msgs/Header header
string path
string[] children
string[] internal_outcomes
string[] outcomes_from
string[] outcomes_to
string[] container_outcomes
"""

MSGS_ROS2 = """
== gazebo_msgs/EntityState
string name
geometry_msgs/Pose pose
geometry_msgs/Twist twist
string reference_frame
"""

_PLACED = "bool success\nstring status_message\n"
_FORCED = "time start_time\nduration duration\n---\n" + _PLACED

SRVS = f"""
== gazebo_msgs/ApplyBodyWrench
string body_name
string reference_frame
geometry_msgs/Point reference_point
geometry_msgs/Wrench wrench
{_FORCED}
== gazebo_msgs/ApplyJointEffort
string joint_name
float64 effort
{_FORCED}
== gazebo_msgs/BodyRequest
string body_name
---
== gazebo_msgs/GetLinkState
string link_name
string reference_frame
---
gazebo_msgs/LinkState link_state
{_PLACED}
== gazebo_msgs/GetPhysicsProperties
---
float64 time_step
bool pause
float64 max_update_rate
geometry_msgs/Vector3 gravity
gazebo_msgs/ODEPhysics ode_config
{_PLACED}
== gazebo_msgs/GetWorldProperties
---
float64 sim_time
string[] model_names
bool rendering_enabled
{_PLACED}
== gazebo_msgs/JointRequest
string joint_name
---
== gazebo_msgs/SetLinkState
gazebo_msgs/LinkState link_state
---
{_PLACED}
== gazebo_msgs/SetPhysicsProperties
float64 time_step
float64 max_update_rate
geometry_msgs/Vector3 gravity
gazebo_msgs/ODEPhysics ode_config
---
{_PLACED}
== mavros_msgs/CommandLong
bool broadcast
uint16 command
uint8 confirmation
float32 param1
float32 param2
float32 param3
float32 param4
float32 param5
float32 param6
float32 param7
---
bool success
uint8 result
== mavros_msgs/StreamRate
uint8 STREAM_ALL=0
uint8 STREAM_RAW_SENSORS=1
uint8 STREAM_EXTENDED_STATUS=2
uint8 STREAM_RC_CHANNELS=3
uint8 STREAM_RAW_CONTROLLER=4
uint8 STREAM_POSITION=6
uint8 STREAM_EXTRA1=10
uint8 STREAM_EXTRA2=11
uint8 STREAM_EXTRA3=12
uint8 stream_id
uint16 message_rate
bool on_off
---
== turtlebot3_msgs/Goal
---
float32 pose_x
float32 pose_y
bool success
"""

SRVS_ROS1 = """
== controller_manager_msgs/ListControllers
---
ControllerState[] controller
== controller_manager_msgs/LoadController
string name
---
bool ok
== controller_manager_msgs/SwitchController
string[] start_controllers
string[] stop_controllers
int32 strictness
int32 BEST_EFFORT=1
int32 STRICT=2
bool start_asap
float64 timeout
---
bool ok
== controller_manager_msgs/UnloadController
string name
---
bool ok
== mavros_msgs/ParamGet
string param_id
---
bool success
mavros_msgs/ParamValue value
== mavros_msgs/ParamSet
string param_id
mavros_msgs/ParamValue value
---
bool success
mavros_msgs/ParamValue value
"""

SRVS_ROS2 = f"""
== gazebo_msgs/DeleteEntity
string name
---
{_PLACED}
== gazebo_msgs/GetEntityState
string name
string reference_frame
---
std_msgs/Header header
gazebo_msgs/EntityState state
bool success
== gazebo_msgs/SetEntityState
gazebo_msgs/EntityState state
---
bool success
== gazebo_msgs/GetModelList
---
std_msgs/Header header
string[] model_names
bool success
== gazebo_msgs/SpawnEntity
string name
string xml
string robot_namespace
geometry_msgs/Pose initial_pose
string reference_frame
---
{_PLACED}
"""

_PLAYING = "bool playing\ntime stamp\n"

ACTIONS_ROS1 = f"""
== kobuki_msgs/AutoDocking
---
string text
---
string state
string text
== sound_play/SoundRequest
SoundRequest sound_request
---
{_PLAYING}
---
{_PLAYING}
"""
