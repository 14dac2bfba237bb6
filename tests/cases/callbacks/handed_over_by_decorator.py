"""A decorator that is a method of a library object passes the function to the library, which may call it at any time."""

import functools

import rospy
import socketio
from flask import Flask, jsonify, request
from sensor_msgs.msg import NavSatFix
from std_msgs.msg import Float64, Int32, String

app = Flask(__name__)
sio = socketio.Server()
state = {"latitude": None, "goal": None, "hits": 0}
latitude = rospy.Publisher("latitude", Float64, queue_size=1)
goals = rospy.Publisher("goals", String, queue_size=1)
hits = rospy.Publisher("hits", Int32, queue_size=1)


def on_fix(fix):
    state["latitude"] = fix.latitude


@app.route("/where")
def where():
    state["hits"] += 1
    hits.publish(state["hits"])  # clean
    latitude.publish(state["latitude"])  # sink fix
    return jsonify(state)


@app.route("/goal/<name>", methods=["POST"])
def set_goal(name):
    state["goal"] = name + request.args["suffix"]
    goals.publish(state["goal"])  # clean


@sio.event
def connect(sid, environ):
    if state["latitude"] > 45.0:
        goals.publish("north")  # sink ~fix
    goals.publish(sid)  # clean


@functools.lru_cache
def never():
    latitude.publish(state["latitude"])  # clean


rospy.init_node("web")
rospy.Subscriber("fix", NavSatFix, on_fix)  # source fix
app.run()
