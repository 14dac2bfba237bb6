"""Find files, read and parse them, and name their modules and packages."""
