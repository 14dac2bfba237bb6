"""Instrument code: from taint lists to numbered sites, instrumented code, and one trace per episode."""
