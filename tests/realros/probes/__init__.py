"""Small programs whose result must be the same on the stand-in and on the real ROS."""
