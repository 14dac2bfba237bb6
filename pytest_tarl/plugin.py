"""The pytest hooks of TARL."""
