"""Exclude modules that cannot influence a result, before anything is interpreted."""
