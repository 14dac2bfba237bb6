"""Report a comparison on the terminal, in HTML and in JSON."""
