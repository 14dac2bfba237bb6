"""A compact form of the analysed code, and its control dependence."""
