"""Install the package."""

from setuptools import setup

setup(
    name="scout_navigation",
    version="0.1.0",
    packages=["scout_navigation"],
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/scout_navigation"]),
        ("share/scout_navigation", ["package.xml"]),
        ("share/scout_navigation/launch", ["launch/bringup.launch.py"]),
        ("share/scout_navigation/config", ["config/gate.yaml"]),
    ],
    entry_points={
        "console_scripts": [
            "planner = scout_navigation.planner:main",
            "gate = scout_navigation.gate:main",
        ]
    },
)
