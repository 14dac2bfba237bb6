"""One file per rule: its code, what it says, and VALID and INVALID snippets that are its tests and its page."""
