"""The settings of a run: keys of pyproject.toml, checked values, wrappers, and rules ignored in some files."""
