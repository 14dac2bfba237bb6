"""A simulator in a process of its own on a real ROS 2, as the world of a test.

`guardian.py` is a second process that starts, watches and kills the simulator and talks to it; `client.py` is the
test's end of it, and `simulator.py` runs nodes and simulator together. The nodes' ROS may be any.
"""
