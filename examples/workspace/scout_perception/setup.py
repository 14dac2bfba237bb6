"""Install the package."""

from setuptools import setup

setup(
    name="scout_perception",
    version="0.1.0",
    packages=["scout_perception"],
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/scout_perception"]),
        ("share/scout_perception", ["package.xml"]),
        ("share/scout_perception/launch", ["launch/perception.launch.xml"]),
    ],
    entry_points={"console_scripts": ["detector = scout_perception.detector:main"]},
)
