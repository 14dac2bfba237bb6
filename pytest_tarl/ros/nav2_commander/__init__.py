"""Stand-in for `nav2_simple_commander`: commands to Nav2 through its actions and services."""
