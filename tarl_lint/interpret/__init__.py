"""The abstract interpretation: transfer functions, calls, and the fixpoint over everything that runs on its own."""
