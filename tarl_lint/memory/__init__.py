"""The abstract domain: objects, values, the heap and the value-flow graph."""
