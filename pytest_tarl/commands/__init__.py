"""The command `tarl`: look at what was recorded without running pytest."""
