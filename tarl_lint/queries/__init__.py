"""Constant propagation queries of the plugin at single sites."""
