"""From the value-flow graph to flows as people see them."""
