"""Run the analysis: groups of files, worker processes, the cache, progress."""
