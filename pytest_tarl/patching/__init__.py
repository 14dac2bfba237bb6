"""Repairs as source: constants changed at their use, guards, subscriptions, the diff."""
