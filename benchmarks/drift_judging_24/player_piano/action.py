"""The action of the grand piano: how long a key takes from its solenoid to the string."""

LIFT = 0.03  # s until a solenoid has built up its field
SWING = 0.055  # s for the hammer of a note of full force
SOFTEST = 0.25

# Bass hammers are heavier; the top of the treble has none of the usual escapement noise.
BASS_BELOW = 40
BASS_FACTOR = 1.15


def clip_force(force):
    """Return a force that the action can play."""
    return max(SOFTEST, min(1.0, force))


def travel_time(key, force):
    """Return the time in s from the current of a solenoid to the sound of its note."""
    swing = SWING / clip_force(force) ** 0.6
    if key < BASS_BELOW:
        swing *= BASS_FACTOR
    return LIFT + swing
