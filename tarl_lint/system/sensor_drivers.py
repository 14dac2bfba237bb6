"""Find the types and names that a sensor driver may use.

A driver is known by its package, or by a word such as `lidar` in the name of its package or program. The types and
words are those of common drivers of the same sensor. A driver of a laser scanner may publish `rear/scan` or
`points_raw`, but neither points named `obstacles` nor a service `release`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

from tarl_lint.name_words import words
from tarl_lint.system.command_topics import COMMANDS


@dataclass(frozen=True)
class Sensor:
    """A kind of sensor.

    `packages` are well-known drivers. `signs` are the words by which other drivers are recognised. `types` are the
    messages and services of the drivers, and `words` are the words of their names.
    """

    packages: frozenset[str]
    signs: frozenset[str]
    types: frozenset[str]
    words: frozenset[str]


def _sensor(packages: str, signs: str, types: str, words: str) -> Sensor:
    return Sensor(*map(_set, (packages, signs, types, words)))


def _set(text: str) -> frozenset[str]:
    return frozenset(text.split())


# types and words that drivers of all sensors have
_TYPES: Final = frozenset(
    ["Bool", "String", "Empty", "Trigger", "SetBool", "Header", "Temperature", "Marker", "MarkerArray",
     "DiagnosticArray", "DiagnosticStatus"]
    + [f"{kind}{form}" for kind in ("Float32", "Float64", "Int8", "Int16", "Int32", "Int64", "UInt8", "UInt16",
                                    "UInt32", "UInt64", "Byte", "Char") for form in ("", "MultiArray")]
)  # fmt: skip
_WORDS: Final = _set(
    "raw data info status state states diagnostics device sensor config configuration settings parameters "
    "firmware version temperature start stop enable disable enabled reset restart reboot power standby resume "
    "pause set get send command cmd request response trigger sync time reference stamp count seq frame id "
    "packet packets datagram telegram stream output out input in marker markers error errors fault health "
    "heartbeat connected front rear back left right top bottom center centre middle upper lower main primary "
    "secondary corrected calibrated calibration calibrate"
)

SENSORS: Final = (
    _sensor(
        "urg_node urg_node2 rplidar_ros sllidar_ros2 ydlidar_ros ydlidar_ros2_driver hls_lfcd_lds_driver "
        "ldlidar_stl_ros2 hokuyo_node lms1xx sick_tim sick_scan sick_scan2 sick_scan_xd sick_safetyscanners "
        "sick_safetyscanners2 xv_11_laser_driver velodyne_driver velodyne_pointcloud velodyne_laserscan "
        "ouster_ros livox_ros_driver livox_ros_driver2 rslidar_sdk",
        "lidar ladar laser scanner sick hokuyo velodyne ouster livox radar sonar ultrasonic tof",
        "LaserScan MultiEchoLaserScan LaserEcho LaserFan PointCloud PointCloud2 Polygon PolygonStamped Range Imu "
        "Image CompressedImage Status Odometry",
        "scan scans scanner laser lidar ladar radar sonar ultrasonic tof lds cloud clouds point points pointcloud "
        "range ranges distance echo echoes multi most intense intensity intensities reflectivity ambient near ir "
        "nearir signal image depth first last sector segment field fields zone zones layer beam beams rpm rpms "
        "motor spin speed encoder imu target targets object objects track tracks detections horizontal vertical "
        "single dual return xyz xyzi ring",
    ),
    _sensor(
        "usb_cam v4l2_camera cv_camera gscam uvc_camera libuvc_camera camera_ros camera1394 openni_camera "
        "openni2_camera astra_camera freenect_camera prosilica_camera realsense2_camera",
        "camera cam realsense zed thermal",
        "Image CompressedImage CameraInfo Packet SetCameraInfo PollImage PointCloud2 DisparityImage Imu "
        "MagneticField FluidPressure Odometry PoseStamped PoseWithCovarianceStamped PointStamped TransformStamped "
        "LaserScan Extrinsics IMUInfo Metadata RGBD DeviceInfo Detection2DArray Detection3DArray",
        "image images img picture camera cam color colour depth rgb rgbd bgr gray grey mono ir infra infrared "
        "infra1 infra2 fisheye thermal rect rectified registered aligned unaligned compressed theora stereo "
        "disparity confidence point points cloud pointcloud scan imu gyro accel mag odom odometry pose exposure "
        "gain white balance brightness video shutter snapshot capture extrinsics metadata projector laser emitter "
        "preset detections",
    ),
    _sensor(
        "",
        "imu microstrain xsens",
        "Imu MagneticField FluidPressure QuaternionStamped Quaternion Vector3 Vector3Stamped TimeReference "
        "NavSatFix Odometry PoseStamped PoseWithCovarianceStamped TwistWithCovarianceStamped",
        "imu imus mag magnetic magnetometer field gyro gyroscope accel accelerometer acceleration angular linear "
        "free velocity delta dv dq orientation attitude quaternion rpy euler roll pitch yaw heading north "
        "pressure baro altitude bias gravity filter filtered filtering odom odometry pose twist gps gnss nav fix "
        "position",
    ),
    _sensor(
        "nmea_navsat_driver",
        "gps gnss ublox novatel septentrio",
        "NavSatFix NavSatStatus TimeReference TwistWithCovarianceStamped QuaternionStamped Odometry Imu "
        "PoseStamped PoseWithCovarianceStamped PointStamped Vector3Stamped Sentence",
        "gps gnss gpsfix fix extended nav navsat sat satellite satellites position velocity vel twist heading rtk "
        "rtcm ntrip nmea sentence gga odom odometry pose utm ecef llh lla enu baseline rover base moving imu pvt "
        "relposned hp",
    ),
)  # fmt: skip
# further words that identify a sensor driver
_OTHERS: Final = frozenset(["barometer", "rfid", "barcode"])
# words of packages that are more than a sensor driver
_ACTIVE: Final = re.compile(
    r"follow|control|nav(?!sat)|track|servo|drive(?!r)|slam|pilot|guard|safe(?!tyscan)|stop|avoid|teleop|plan|fus|"
    r"filter|base|robot|sim|odom|match|joint|tilt|goal|map|graph|mount|(?<![a-z])pan(?![a-z])"
)
# words of programs that process sensor data and may publish any type
_PROCESSING: Final = re.compile(
    r"detect|segment|cluster|proc|percept|recogn|obstacle|people|person|human|face|leg|object|estimat|merg|assembl|"
    r"conver|(?<![a-z])to(?![a-z])|[a-z]2[a-z]|view|display|record|server|bridge|relay|mux|throttle|transform|fake|"
    r"mock|dummy|virtual|play|calib|line|marker|tag|project|stitch|regist|monitor|learn|predict|classif|yolo|collect|"
    r"demo|example|tutorial|test|tool|util|local|loc(?![a-z])|measure|extract|search|find|count|collision|watch|"
    r"manager|supervis|gate|web|stream|rviz|rqt"
)
_SIGN: Final = re.compile(
    rf"(?<![a-z])({'|'.join(sorted(_OTHERS.union(*(one.signs for one in SENSORS))))})(?![a-z])"
)
# types that drivers of sensors do not use
_NEVER: Final = COMMANDS | {"Joy", "Path", "OccupancyGrid", "JointState", "PoseArray"}
# words in package and program names that say nothing about topics
_EMPTY: Final = frozenset(
    ["ros", "node", "nodelet", "driver", "drivers", "component", "generic", "caller", "py", "exe"]
)


def sensors(package: str, program: str) -> tuple[Sensor, ...]:
    """Return the kinds of sensors that a program drives; empty if none."""
    known = tuple(one for one in SENSORS if package in one.packages)
    if known or _PROCESSING.search(f"{package}/{program}".lower()):
        return known
    signs = _signs(package, program)
    return tuple(one for one in SENSORS if not signs.isdisjoint(one.signs))


def _signs(package: str, program: str) -> frozenset[str]:
    text = f"{package}/{program}".lower()
    return frozenset() if _ACTIVE.search(text) else frozenset(_SIGN.findall(text))


def driver_types(package: str, program: str) -> frozenset[str] | None:
    """Return the types that a sensor driver may use; None if its sensor is unknown."""
    found = sensors(package, program)
    return frozenset(_TYPES.union(*(one.types for one in found))) - _NEVER if found else None


def driver_words(package: str, program: str) -> frozenset[str] | None:
    """Return the words in a driver's topic names; None if its sensor is unknown."""
    found = sensors(package, program)
    own = words(package) | words(program)
    return _WORDS.union(own - _EMPTY, *(one.words for one in found)) if found else None


def unused_types(package: str, program: str) -> frozenset[str]:
    """Return types that a program never uses, such as a driver's commands."""
    return frozenset(_NEVER) if _signs(package, program) else frozenset()


def offered(name: str, vocabulary: Iterable[str]) -> bool:
    """Return whether a topic's last part has only known words."""
    return words(name.rpartition("/")[2]) <= frozenset(vocabulary)
