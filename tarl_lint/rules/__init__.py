"""Rules, one file each: code, message, and the VALID and INVALID snippets that are its tests and documentation."""
