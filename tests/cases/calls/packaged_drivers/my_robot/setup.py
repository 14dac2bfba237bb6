from setuptools import setup, find_packages
setup(name="my_robot", packages=find_packages(), entry_points={"console_scripts": ["drive = my_robot.node:main"]})
