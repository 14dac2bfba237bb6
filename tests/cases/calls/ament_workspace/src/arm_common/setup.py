from setuptools import setup

setup(name="arm_common", packages=["arm_common"])
