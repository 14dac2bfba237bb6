"""The nodes of a launch file as one system: which topics they use, and which data flows across them."""
