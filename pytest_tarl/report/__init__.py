"""Report the result of a comparison to people (terminal, HTML page) and to other tools (JSON)."""
