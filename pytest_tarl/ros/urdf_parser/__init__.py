"""urdf_parser_py: read robot descriptions (URDF). If the real urdf_parser_py is installed, it takes precedence."""
