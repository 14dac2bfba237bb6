"""Collect and judge the missions of many robots."""
