"""Use a simulator as the world of a test. The simulator runs in its own process on a real ROS 1 or ROS 2.

`guardian.py` is a further process, which starts, monitors and kills the simulator, and exchanges messages with it.
`client.py` is the test's connection to the guardian. `simulator.py` runs the nodes and the simulator together. The
nodes may use any ROS.
"""
