"""urdf_parser_py: read robot descriptions (URDF). An installed urdf_parser_py takes precedence."""
