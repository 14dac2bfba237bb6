"""What cannot matter, told before anything is interpreted."""
