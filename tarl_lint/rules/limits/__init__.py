"""Range checks, for rules about magnitudes."""
