"""What an on-line run found, told to people (terminal, page) and to other tools (JSON)."""
