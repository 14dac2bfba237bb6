"""The profile of the soldering head for lead-free solder and the 2 mm tip."""

IRON = {"temperature": 350.0, "idle": 180.0, "ready_within": 5.0}  # degrees C

# A joint is heated for `factor` times its time constant, which grows with the size of the pad.
HEATING = {"factor": 1.04, "base": 0.70, "per_mm2": 0.25}  # -, s, s

MOTION = {"approach": 0.3, "retract": 0.2, "cool": 0.3}  # s


def dwell(area):
    """Return the seconds for which the tip stays on a pad with this area in mm²."""
    constant = HEATING["base"] + HEATING["per_mm2"] * area
    return HEATING["factor"] * constant
