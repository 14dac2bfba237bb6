"""What the abstract interpretation works on: objects, values, the heap and the value-flow graph."""
