"""The settings of a run: keys of pyproject.toml, checked values, wrappers, ignores by file."""
