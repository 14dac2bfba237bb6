from setuptools import setup

setup(
    name="arm_control",
    packages=["arm_control"],
    entry_points={"console_scripts": ["arm = arm_control.node:main"]},
)
