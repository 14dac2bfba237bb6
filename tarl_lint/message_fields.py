"""Fields of messages of the standard packages, and of other packages with messages for commands and displays."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

NUMBERS: Final = (
    "Bool", "Byte", "Char", "Duration", "Float32", "Float64", "Int8", "Int16", "Int32", "Int64", "String", "Time",
    "UInt8", "UInt16", "UInt32", "UInt64",
)  # fmt: skip
STAMPED: Final = ("Point", "Quaternion", "Pose", "Twist", "Accel", "Wrench")


def _fields(names: str, kind: str = "") -> dict[str, str]:
    return dict.fromkeys(names.split(), kind)


HEADED: Final = _fields("header", "Header")
# message types for which the analysis can detect that a program replaces every field of a copied message
FIELDS: Final[Mapping[str, Mapping[str, str]]] = {
    **{name: _fields("data") for name in NUMBERS},
    "ColorRGBA": _fields("r g b a"),
    "Header": _fields("stamp frame_id"),
    "Point": _fields("x y z"),
    "Point32": _fields("x y z"),
    "Vector3": _fields("x y z"),
    "Quaternion": _fields("x y z w"),
    "Pose2D": _fields("x y theta"),
    "Pose": _fields("position", "Point") | _fields("orientation", "Quaternion"),
    "Twist": _fields("linear angular", "Vector3"),
    "Accel": _fields("linear angular", "Vector3"),
    "Wrench": _fields("force torque", "Vector3"),
    "Transform": _fields("translation", "Vector3") | _fields("rotation", "Quaternion"),
    **{f"{name}Stamped": HEADED | _fields(name.lower(), name) for name in STAMPED},
    "Vector3Stamped": HEADED | _fields("vector", "Vector3"),
    "TransformStamped": HEADED | _fields("child_frame_id") | _fields("transform", "Transform"),
    "PoseWithCovariance": _fields("pose", "Pose") | _fields("covariance"),
    "TwistWithCovariance": _fields("twist", "Twist") | _fields("covariance"),
    "PoseWithCovarianceStamped": HEADED | _fields("pose", "PoseWithCovariance"),
    "Odometry": HEADED
    | _fields("child_frame_id")
    | _fields("pose", "PoseWithCovariance")
    | _fields("twist", "TwistWithCovariance"),
    "Path": HEADED | _fields("poses"),
    "PoseArray": HEADED | _fields("poses"),
    "MapMetaData": _fields("map_load_time resolution width height") | _fields("origin", "Pose"),
    "OccupancyGrid": HEADED | _fields("info", "MapMetaData") | _fields("data"),
    "Image": HEADED | _fields("height width encoding is_bigendian step data"),
    "CompressedImage": HEADED | _fields("format data"),
    "JointState": HEADED | _fields("name position velocity effort"),
    "Joy": HEADED | _fields("axes buttons"),
    "LaserScan": HEADED
    | _fields(
        "angle_min angle_max angle_increment time_increment scan_time range_min range_max ranges intensities"
    ),
}  # message type → name of a field → type of the field; only for fields whose type has fields of its own

_ARRAYS: Final = (
    "Byte",
    "Float32",
    "Float64",
    "Int8",
    "Int16",
    "Int32",
    "Int64",
    "UInt8",
    "UInt16",
    "UInt32",
    "UInt64",
)
_BEAMS: Final = HEADED | _fields(
    "angle_min angle_max angle_increment time_increment scan_time range_min range_max ranges intensities"
)
# all types of the standard packages; a field counts as known if it exists in any release of ROS 1 or ROS 2
ALL_FIELDS: Final[Mapping[str, Mapping[str, str]]] = {
    **FIELDS,
    "Header": _fields("seq stamp frame_id"),
    **{f"{name}MultiArray": _fields("layout", "MultiArrayLayout") | _fields("data") for name in _ARRAYS},
    "MultiArrayLayout": _fields("dim data_offset"),
    "MultiArrayDimension": _fields("label size stride"),
    "AccelWithCovariance": _fields("accel", "Accel") | _fields("covariance"),
    "AccelWithCovarianceStamped": HEADED | _fields("accel", "AccelWithCovariance"),
    "TwistWithCovarianceStamped": HEADED | _fields("twist", "TwistWithCovariance"),
    "VelocityStamped": HEADED | _fields("body_frame_id reference_frame_id") | _fields("velocity", "Twist"),
    "Inertia": _fields("m ixx ixy ixz iyy iyz izz") | _fields("com", "Vector3"),
    "InertiaStamped": HEADED | _fields("inertia", "Inertia"),
    "Polygon": _fields("points"),
    "PolygonInstance": _fields("polygon", "Polygon") | _fields("id"),
    "PolygonInstanceStamped": HEADED | _fields("polygon", "PolygonInstance"),
    "PolygonStamped": HEADED | _fields("polygon", "Polygon"),
    "Goals": HEADED | _fields("goals"),
    "Trajectory": HEADED | _fields("points"),
    "TrajectoryPoint": HEADED
    | _fields("pose", "Pose")
    | _fields("velocity", "Twist")
    | _fields("acceleration", "Accel")
    | _fields("effort", "Wrench"),
    "GridCells": HEADED | _fields("cell_width cell_height cells"),
    "BatteryState": HEADED
    | _fields("voltage temperature current charge capacity design_capacity percentage power_supply_status")
    | _fields("power_supply_health power_supply_technology present cell_voltage cell_temperature location")
    | _fields("serial_number"),
    "CameraInfo": HEADED
    | _fields("height width distortion_model d k r p D K R P binning_x binning_y")
    | _fields("roi", "RegionOfInterest"),
    "ChannelFloat32": _fields("name values"),
    "FluidPressure": HEADED | _fields("fluid_pressure variance"),
    "Illuminance": HEADED | _fields("illuminance variance"),
    "Imu": HEADED
    | _fields("orientation", "Quaternion")
    | _fields("angular_velocity linear_acceleration", "Vector3")
    | _fields("orientation_covariance angular_velocity_covariance linear_acceleration_covariance"),
    "JoyFeedback": _fields("type id intensity"),
    "JoyFeedbackArray": _fields("array"),
    "LaserEcho": _fields("echoes"),
    "MagneticField": HEADED | _fields("magnetic_field", "Vector3") | _fields("magnetic_field_covariance"),
    "MultiDOFJointState": HEADED | _fields("joint_names transforms twist wrench"),
    "MultiEchoLaserScan": _BEAMS,
    "NavSatFix": HEADED
    | _fields("status", "NavSatStatus")
    | _fields("latitude longitude altitude position_covariance position_covariance_type"),
    "NavSatStatus": _fields("status service"),
    "PointCloud": HEADED | _fields("points channels"),
    "PointCloud2": HEADED | _fields("height width fields is_bigendian point_step row_step data is_dense"),
    "PointField": _fields("name offset datatype count"),
    "Range": HEADED | _fields("radiation_type field_of_view min_range max_range range variance"),
    "RegionOfInterest": _fields("x_offset y_offset height width do_rectify"),
    "RelativeHumidity": HEADED | _fields("relative_humidity variance"),
    "Temperature": HEADED | _fields("temperature variance"),
    "TimeReference": HEADED | _fields("time_ref source"),
}
# ALL_FIELDS, and the command and display messages of other packages
KNOWN_FIELDS: Final[Mapping[str, Mapping[str, str]]] = {
    **ALL_FIELDS,
    "JointTrajectory": HEADED | _fields("joint_names points"),
    "JointTrajectoryPoint": _fields("positions velocities accelerations effort time_from_start"),
    "AckermannDrive": _fields("steering_angle steering_angle_velocity speed acceleration jerk"),
    "AckermannDriveStamped": HEADED | _fields("drive", "AckermannDrive"),
    "GripperCommand": _fields("position max_effort"),
    "Marker": HEADED
    | _fields(
        "ns id type action lifetime frame_locked points colors text mesh_resource mesh_file texture_resource"
    )
    | _fields("texture uv_coordinates mesh_use_embedded_materials")
    | _fields("pose", "Pose")
    | _fields("scale", "Vector3")
    | _fields("color", "ColorRGBA"),
    "MarkerArray": _fields("markers"),
    "DiagnosticArray": HEADED | _fields("status"),
    "DiagnosticStatus": _fields("level name message hardware_id values"),
    "KeyValue": _fields("key value"),
    "GeoPoint": _fields("latitude longitude altitude"),
    "GeoPose": _fields("position", "GeoPoint") | _fields("orientation", "Quaternion"),
    "GeoPointStamped": HEADED | _fields("position", "GeoPoint"),
    "GeoPoseStamped": HEADED | _fields("pose", "GeoPose"),
    "SetBool.Request": _fields("data"),
    "SetBool.Response": _fields("success message"),
    "Trigger.Response": _fields("success message"),
    "GetMap.Response": _fields("map", "OccupancyGrid"),
    "GetPlan.Request": _fields("start goal", "PoseStamped") | _fields("tolerance"),
    "GetPlan.Response": _fields("plan", "Path"),
}
# type → `field[]` → type of the elements of a list
ELEMENTS: Final[Mapping[str, Mapping[str, str]]] = {
    "DiagnosticArray": {"status[]": "DiagnosticStatus"},
    "DiagnosticStatus": {"values[]": "KeyValue"},
    "Polygon": {"points[]": "Point32"},
    "PoseArray": {"poses[]": "Pose"},
    "Goals": {"goals[]": "PoseStamped"},
    "GridCells": {"cells[]": "Point"},
    "Path": {"poses[]": "PoseStamped"},
    "Trajectory": {"points[]": "TrajectoryPoint"},
    "JoyFeedbackArray": {"array[]": "JoyFeedback"},
    "MultiDOFJointState": {"transforms[]": "Transform", "twist[]": "Twist", "wrench[]": "Wrench"},
    "MultiEchoLaserScan": {"ranges[]": "LaserEcho", "intensities[]": "LaserEcho"},
    "PointCloud": {"points[]": "Point32", "channels[]": "ChannelFloat32"},
    "PointCloud2": {"fields[]": "PointField"},
    "MultiArrayLayout": {"dim[]": "MultiArrayDimension"},
    "JointTrajectory": {"points[]": "JointTrajectoryPoint"},
    "Marker": {"points[]": "Point", "colors[]": "ColorRGBA"},
    "MarkerArray": {"markers[]": "Marker"},
}
# types whose fields that contain numbers contain whole numbers
WHOLE: Final = frozenset(f"{name}{part}" for name in NUMBERS if "Int" in name for part in ("", "MultiArray"))
# type → its fields that contain a number, or, as `field[]`, a list of numbers
NUMBER_FIELDS: Final[Mapping[str, frozenset[str]]] = {
    **{name: frozenset(["data"]) for name in ("Bool", "Float32", "Float64", *WHOLE) if name in NUMBERS},
    **{f"{name}MultiArray": frozenset(["data[]"]) for name in _ARRAYS if name != "Byte"},
    **{
        name: frozenset(FIELDS[name])
        for name in ("Point", "Point32", "Vector3", "Quaternion", "Pose2D", "ColorRGBA")
    },
    "LaserScan": frozenset(
        ["angle_min", "angle_max", "angle_increment", "range_min", "range_max", "ranges[]"]
    ),
    "JointState": frozenset(["position[]", "velocity[]", "effort[]"]),
    "Joy": frozenset(["axes[]", "buttons[]"]),
    "Range": frozenset(["field_of_view", "min_range", "max_range", "range"]),
    "Temperature": frozenset(["temperature"]),
    "NavSatFix": frozenset(["latitude", "longitude", "altitude"]),
    "BatteryState": frozenset(["voltage", "temperature", "current", "charge", "capacity", "percentage"]),
    "AckermannDrive": frozenset(
        ["steering_angle", "steering_angle_velocity", "speed", "acceleration", "jerk"]
    ),
}


def _camera(names: str) -> dict[str, str]:
    """Return the fields of a CameraInfo whose matrices have these names."""
    others = {name: kind for name, kind in ALL_FIELDS["CameraInfo"].items() if name.lower() not in "dkrp"}
    return others | _fields(names)


_TIME: Final = "builtin_interfaces/Time"
# release of ROS, "1" or "2" → message types whose fields are different in the other release
BY_RELEASE: Final[Mapping[str, Mapping[str, Mapping[str, str]]]] = {
    "1": {
        "CameraInfo": _camera("D K R P"),
        "Header": _fields("seq frame_id") | _fields("stamp", _TIME),
        _TIME: _fields("secs nsecs to_sec to_nsec to_time is_zero set canon from_sec from_seconds now"),
    },
    "2": {
        "CameraInfo": _camera("d k r p"),
        "Header": _fields("frame_id") | _fields("stamp", _TIME),
        _TIME: _fields("sec nanosec"),
    },
}
# package → the names in KNOWN_FIELDS that may be types of this package
PACKAGES: Final[Mapping[str, frozenset[str]]] = {
    **dict.fromkeys(("std_msgs", "geometry_msgs", "sensor_msgs"), frozenset(ALL_FIELDS)),
    "nav_msgs": frozenset([*ALL_FIELDS, "GetMap.Response", "GetPlan.Request", "GetPlan.Response"]),
    "std_srvs": frozenset(["SetBool.Request", "SetBool.Response", "Trigger.Response"]),
    "trajectory_msgs": frozenset(["JointTrajectory", "JointTrajectoryPoint"]),
    "ackermann_msgs": frozenset(["AckermannDrive", "AckermannDriveStamped"]),
    "control_msgs": frozenset(["GripperCommand"]),
    "visualization_msgs": frozenset(["Marker", "MarkerArray"]),
    "diagnostic_msgs": frozenset(["DiagnosticArray", "DiagnosticStatus", "KeyValue"]),
    "geographic_msgs": frozenset(["GeoPoint", "GeoPose", "GeoPointStamped", "GeoPoseStamped"]),
}
