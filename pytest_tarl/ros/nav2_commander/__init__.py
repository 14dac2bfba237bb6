"""Stand-in for `nav2_simple_commander`: commands to Nav2 by its actions and services."""
