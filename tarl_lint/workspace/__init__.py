"""Read a ROS workspace as text: packages, nodes, importable modules, interfaces, launch and parameter files.

Nothing is executed: `setup.py`, `.cfg` and launch files are interpreted as far as their values are constant.
"""
