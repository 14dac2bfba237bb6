"""A simulator in a process of its own on a real ROS 2, as the world of a test.

`guardian.py` is a second process, which starts, watches and kills the simulator and exchanges messages with it.
`client.py` is the test's connection to the guardian, and `simulator.py` runs nodes and simulator together. The nodes
may use any ROS.
"""
