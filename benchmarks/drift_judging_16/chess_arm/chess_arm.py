#!/usr/bin/env python
"""Plays the moves of a chess engine with an arm on a table."""

from collections import namedtuple

import rospy
from board import Board, grip_height
from geometry_msgs.msg import Point, PointStamped, Pose2D
from std_msgs.msg import Bool, String

Waypoint = namedtuple("Waypoint", "x y z closed dwell")
HOME = (0.10, -0.12)


class Player:
    def __init__(self):
        self.board = Board(
            square=rospy.get_param("~square_size", 0.050), frame=rospy.get_param("~frame_width", 0.018)
        )
        self.travel_z = rospy.get_param("~travel_height", 0.16)
        self.reached = rospy.get_param("~tolerance", 0.004)
        self.dwell = rospy.get_param("~grip_time", 0.6)
        self.patience = rospy.get_param("~waypoint_timeout", 8.0)
        self.share = rospy.get_param("~pose_filter", 0.15)
        self.tip = None
        self.plan = []
        self.arrived_at = None
        self.started_at = rospy.Time.now()
        self.target_pub = rospy.Publisher("arm/target", Point, queue_size=1)
        self.grip_pub = rospy.Publisher("gripper/close", Bool, queue_size=1)
        self.state_pub = rospy.Publisher("player/state", String, queue_size=1)
        rospy.Subscriber("arm/tip", PointStamped, self.on_tip)
        rospy.Subscriber("board/corner", Pose2D, self.on_corner)
        rospy.Subscriber("chess/move", String, self.on_move)

    def on_tip(self, msg):
        self.tip = msg.point

    def on_corner(self, msg):
        if not self.plan:  # the arm hides the board while it moves
            self.board.update(msg.x, msg.y, msg.theta, self.share)

    def on_move(self, msg):
        piece, squares = msg.data.split(" ")
        if self.plan or not self.board.seen:
            rospy.logwarn("not ready for %s", msg.data)
            return
        z = grip_height(piece)
        start, end = self.board.centre(squares[:2]), self.board.centre(squares[2:4])
        self.plan = [
            Waypoint(*start, self.travel_z, False, 0.0),
            Waypoint(*start, z, False, 0.2),
            Waypoint(*start, z, True, self.dwell),
            Waypoint(*start, self.travel_z, True, 0.0),
            Waypoint(*end, self.travel_z, True, 0.2),
            Waypoint(*end, z + 0.001, True, 0.2),
            Waypoint(*end, z + 0.001, False, self.dwell),
            Waypoint(*end, self.travel_z, False, 0.0),
            Waypoint(*HOME, self.travel_z, False, 0.0),
        ]
        self.started_at = rospy.Time.now()

    def there(self, goal):
        off = max(abs(self.tip.x - goal.x), abs(self.tip.y - goal.y), abs(self.tip.z - goal.z))
        return off < self.reached

    def step(self):
        if self.tip is None:
            return
        if not self.plan:
            self.state_pub.publish("IDLE")
            return
        self.state_pub.publish("MOVING")
        goal, now = self.plan[0], rospy.Time.now()
        self.target_pub.publish(Point(goal.x, goal.y, goal.z))
        self.grip_pub.publish(goal.closed)
        if self.arrived_at is None and self.there(goal):
            self.arrived_at = now
        waited = self.arrived_at is not None and (now - self.arrived_at).to_sec() >= goal.dwell
        if waited or (now - self.started_at).to_sec() > self.patience:
            self.plan.pop(0)
            self.arrived_at, self.started_at = None, now


def main():
    rospy.init_node("chess_arm")
    player = Player()
    rate = rospy.Rate(10)
    while not rospy.is_shutdown():
        player.step()
        rate.sleep()


if __name__ == "__main__":
    main()
