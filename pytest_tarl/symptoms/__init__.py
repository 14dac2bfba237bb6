"""Symptoms: signs in recorded values that a certain structural change of the code could compensate the drift."""
