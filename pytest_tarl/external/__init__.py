"""Use a simulator on a real ROS as the world of a test.

`guardian.py` is a separate process that starts, monitors and kills the simulator, and exchanges messages with it.
`client.py` is the test's connection to the guardian. `simulator.py` runs nodes and simulator together. The nodes may
use any ROS.
"""
