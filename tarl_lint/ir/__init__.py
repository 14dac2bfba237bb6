"""A compact form of the code that is read, and what its control flow says."""
