"""Symptoms: signs in recorded values that say which change of structure a drift needs."""
