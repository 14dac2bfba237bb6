#!/usr/bin/env python
"""Winds filament around a mandrel: the carriage moves along it in step with its turns, to the end and back."""

import math

import rospy
from geometry_msgs.msg import Vector3Stamped
from std_msgs.msg import Bool, Float32, Int32

params = {}
state = {
    "turns": 0.0,  # of the mandrel since the start
    "rate": 0.0,  # turns per s
    "angle": None,
    "carriage": None,
    "tension": None,
    "tension_faults": 0,
    "winding": False,
    "layers": 0,
    "outbound": True,
}


def load_params():
    for name in ("pitch", "length", "gain", "max_speed", "dead_zone"):
        params[name] = float(rospy.get_param("~" + name))
    params["layers"] = int(rospy.get_param("~layers", 12))
    params["tension_min"] = float(rospy.get_param("~tension_min", 8.0))
    params["period"] = 1.0 / float(rospy.get_param("~frequency", 20.0))


def on_mandrel(msg):
    """Count the turns; the vector holds the angle of the mandrel in rad as x, and its motor's current as y."""
    angle = msg.vector.x
    if state["angle"] is not None and state["winding"]:
        step = (angle - state["angle"] + math.pi) % (2.0 * math.pi) - math.pi
        turned = step / (2.0 * math.pi)
        state["turns"] += turned
        state["rate"] += 0.2 * (turned / params["period"] - state["rate"])
    state["angle"] = angle


def on_carriage(msg):
    state["carriage"] = msg.data


def on_tension(msg):
    state["tension"] = msg.data
    if msg.data < params["tension_min"]:
        state["tension_faults"] += 1
        rospy.logwarn_throttle(5.0, "tension of %.1f N" % msg.data)
    else:
        state["tension_faults"] = 0


def on_start(msg):
    if msg.data and not state["winding"]:
        rospy.loginfo("winding %d layers of %.2f m" % (params["layers"], params["length"]))
        state.update(winding=True, turns=0.0, layers=0)
    elif not msg.data:
        state["winding"] = False


def place():
    """Return where the carriage should be, in m from the start, and whether it goes out (1) or back (-1)."""
    way = state["turns"] * params["pitch"]
    layer = int(way // params["length"])
    if layer > state["layers"]:
        state["layers"] = layer
    rest = way - layer * params["length"]
    if layer % 2 == 0:
        return rest, 1
    return params["length"] - rest, -1


def speed_towards(target):
    error = target - state["carriage"]
    if abs(error) < params["dead_zone"]:
        return 0.0
    return params["gain"] * error


class Loop(object):
    def __init__(self):
        self.speed_pub = rospy.Publisher("carriage/speed", Float32, queue_size=1)
        self.layer_pub = rospy.Publisher("winder/layer", Int32, queue_size=1)
        self.rate_pub = rospy.Publisher("winder/rate", Float32, queue_size=1)
        self.stop_pub = rospy.Publisher("winder/stop", Bool, queue_size=1)

    def step(self, event):
        speed = 0.0
        if state["winding"] and state["carriage"] is not None:
            target, direction = place()
            state["outbound"] = direction > 0
            if state["layers"] >= params["layers"] or state["tension_faults"] > 20:
                state["winding"] = False
                self.stop_pub.publish(True)
            else:
                speed = speed_towards(target)
                limit = params["max_speed"]
                if abs(speed) > limit:
                    speed = math.copysign(limit, speed)
        self.speed_pub.publish(speed)

    def show(self, event):
        self.layer_pub.publish(state["layers"])
        self.rate_pub.publish(state["rate"])
        rospy.logdebug("layer %d, %s" % (state["layers"], "out" if state["outbound"] else "back"))


def main():
    rospy.init_node("filament_winder")
    load_params()
    loop = Loop()
    rospy.Subscriber("mandrel/state", Vector3Stamped, on_mandrel)
    rospy.Subscriber("carriage/position", Float32, on_carriage)
    rospy.Subscriber("eyelet/tension", Float32, on_tension)
    rospy.Subscriber("panel/start", Bool, on_start)
    rospy.Timer(rospy.Duration(params["period"]), loop.step)
    rospy.Timer(rospy.Duration(1.0), loop.show)
    rospy.spin()


if __name__ == "__main__":
    main()
