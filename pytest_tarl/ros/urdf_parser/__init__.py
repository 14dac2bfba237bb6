"""urdf_parser_py: read robot descriptions (URDF). An installed urdf_parser_py takes precedence."""

from pytest_tarl.ros.missing import refusing

__getattr__ = refusing("urdf_parser_py")
