"""The package `urdf_parser_py`, whose contents are in its module `urdf`."""

from pytest_tarl.ros.missing import refusing

__getattr__ = refusing("urdf_parser_py")
