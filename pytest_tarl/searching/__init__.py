"""Which mutation, under which guard, and does it hold."""
