from setuptools import setup

setup(
    name="sim",
    packages=["sim"],
    entry_points={"console_scripts": ["echo = sim.echo:begin"]},
)
