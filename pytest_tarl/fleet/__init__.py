"""Missions of many robots: recordings and logs merged into one recording."""
