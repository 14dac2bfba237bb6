"""Install the nodes and the launch file of cold_store."""

from setuptools import setup

setup(
    name="cold_store",
    version="0.1.0",
    packages=["cold_store"],
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/cold_store"]),
        ("share/cold_store", ["package.xml"]),
        ("share/cold_store/launch", ["launch/cold_store.launch.py"]),
    ],
    entry_points={
        "console_scripts": [
            "climate_node = cold_store.climate_node:main",
            "fan_node = cold_store.fan_node:main",
            "logbook_node = cold_store.logbook_node:main",
        ],
    },
)
