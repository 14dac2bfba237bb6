"""Constant propagation queries, which the plugin asks about single sites."""
