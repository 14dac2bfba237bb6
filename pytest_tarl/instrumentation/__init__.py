"""From taint lists to recorded events: numbered sites, instrumented code, one trace an episode."""
