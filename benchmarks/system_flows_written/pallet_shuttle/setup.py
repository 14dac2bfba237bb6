"""Install the nodes and the launch file of pallet_shuttle."""

from setuptools import setup

setup(
    name="pallet_shuttle",
    version="0.1.0",
    packages=["pallet_shuttle"],
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/pallet_shuttle"]),
        ("share/pallet_shuttle", ["package.xml"]),
        ("share/pallet_shuttle/launch", ["launch/shuttle.launch.py"]),
    ],
    entry_points={
        "console_scripts": [
            "drive_node = pallet_shuttle.drive_node:main",
            "lift_node = pallet_shuttle.lift_node:main",
            "mission_node = pallet_shuttle.mission_node:main",
        ],
    },
)
