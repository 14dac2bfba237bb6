#!/usr/bin/env python
"""Steers a peat harvester along its track: pure pursuit of a point on the track some way ahead."""

import math

import rospy
from geometry_msgs.msg import Pose2D, PoseArray, Twist
from std_msgs.msg import Bool, Float32


class Track(object):
    """A polyline that is followed from its begin to its end."""

    def __init__(self, points):
        self.points = points
        self.lengths = [math.hypot(b[0] - a[0], b[1] - a[1]) for a, b in zip(points[:-1], points[1:])]
        self.total = sum(self.lengths)
        self.segment = 0

    def project(self, x, y):
        """Return the way along the track of the place that is nearest to a point, and their distance."""
        best = None
        for number in range(self.segment, min(self.segment + 3, len(self.lengths))):
            a, b = self.points[number], self.points[number + 1]
            length = self.lengths[number]
            along = ((x - a[0]) * (b[0] - a[0]) + (y - a[1]) * (b[1] - a[1])) / length
            along = max(0.0, min(length, along))
            px = a[0] + (b[0] - a[0]) * along / length
            py = a[1] + (b[1] - a[1]) * along / length
            away = math.hypot(x - px, y - py)
            if best is None or away < best[0]:
                best = away, number, along
        away, self.segment, along = best
        away, self.segment, along = best
        return sum(self.lengths[: self.segment]) + along, away

    def at(self, way):
        """Return the point at a way along the track, beyond its end too."""
        number = 0
        while way > self.lengths[number] and number < len(self.lengths) - 1:
            way -= self.lengths[number]
            number += 1
        a, b = self.points[number], self.points[number + 1]
        share = way / self.lengths[number]
        return a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])


class Harvester(object):
    def __init__(self):
        get = rospy.get_param
        self.lookahead = get("~lookahead")
        self.speed = get("~speed")
        self.wheelbase = get("~wheelbase", 2.1)
        self.max_steer = math.radians(get("~max_steer_degrees", 38.0))
        self.lost_at = get("~lost_at", 6.0)
        self.pose = None
        self.track = None
        self.hopper_full = False
        self.steer_pub = rospy.Publisher("steering/angle", Float32, queue_size=1)
        self.cmd_pub = rospy.Publisher("drive/cmd", Twist, queue_size=1)
        self.off_pub = rospy.Publisher("harvester/off_track", Float32, queue_size=1)
        self.done_pub = rospy.Publisher("harvester/done", Bool, queue_size=1)

    def on_pose(self, msg):
        self.pose = msg

    def on_track(self, msg):
        if self.track is None and len(msg.poses) > 1:
            self.track = Track([(pose.position.x, pose.position.y) for pose in msg.poses])
            rospy.loginfo("track of %.0f m", self.track.total)

    def on_hopper(self, msg):
        self.hopper_full = msg.data

    def steering(self, goal):
        """Return the angle of the wheels whose circle leads through a point."""
        dx, dy = goal[0] - self.pose.x, goal[1] - self.pose.y
        side = -math.sin(self.pose.theta) * dx + math.cos(self.pose.theta) * dy
        angle = math.atan2(2.0 * self.wheelbase * side, dx * dx + dy * dy)
        return max(-self.max_steer, min(self.max_steer, angle))

    def step(self, event):
        if self.pose is None or self.track is None:
            return
        command = Twist()
        way, away = self.track.project(self.pose.x, self.pose.y)
        self.off_pub.publish(away)
        if way >= self.track.total - 0.5:
            self.done_pub.publish(True)
        elif away > self.lost_at:
            rospy.logerr_throttle(5.0, "%.1f m beside the track", away)
        elif not self.hopper_full:
            command.linear.x = self.speed
            self.steer_pub.publish(self.steering(self.track.at(way + self.lookahead)))
        self.cmd_pub.publish(command)


def main():
    rospy.init_node("peat_harvester")
    harvester = Harvester()
    rospy.Subscriber("gps/pose", Pose2D, harvester.on_pose)
    rospy.Subscriber("field/track", PoseArray, harvester.on_track)
    rospy.Subscriber("hopper/full", Bool, harvester.on_hopper)
    rospy.Timer(rospy.Duration(0.2), harvester.step)
    rospy.spin()


if __name__ == "__main__":
    main()
