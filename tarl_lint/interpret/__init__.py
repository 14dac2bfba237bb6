"""The abstract interpretation: transfer functions, calls, and the fixpoint over all entry points."""
