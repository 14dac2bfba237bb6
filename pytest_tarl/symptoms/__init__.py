"""Symptoms: signs in recorded values that suggest which structural change of the code compensates a drift."""
