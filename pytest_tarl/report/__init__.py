"""Report the result of a comparison to people (terminal, page) and to other tools (JSON)."""
