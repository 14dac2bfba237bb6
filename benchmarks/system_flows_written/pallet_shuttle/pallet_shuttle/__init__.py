"""Nodes of a shuttle for pallets: drive, lift and mission."""
