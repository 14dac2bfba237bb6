"""Missions that come one by one and never end, watched for a loss of performance and for a change of the world."""
