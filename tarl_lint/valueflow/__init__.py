"""The value-flow graph: what every statement takes from which other, over a whole set of modules."""
