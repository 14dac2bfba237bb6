"""How ament installs this package."""

from setuptools import setup

setup(
    name="ament_tarl_lint",
    version="0.1.0",
    packages=["ament_tarl_lint"],
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/ament_tarl_lint"]),
        ("share/ament_tarl_lint", ["package.xml"]),
    ],
    install_requires=["setuptools"],
    zip_safe=True,
    maintainer="The TARL maintainers",
    description="Lint Python nodes with tarl-lint.",
    license="Apache-2.0",
    entry_points={"console_scripts": ["ament_tarl_lint = ament_tarl_lint.main:main"]},
)
