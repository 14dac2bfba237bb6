"""A node on a robot, watched: its steps, its sensors and its reward, appended to a log that `--tarl-log` reads."""
