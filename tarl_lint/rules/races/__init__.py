"""Held locks, threads and accesses, for rules about races."""
