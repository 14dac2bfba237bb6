"""Models of code that is not analysed: containers, records, strings, futures, ROS."""
