"""What rules about magnitudes ask: range checks."""
