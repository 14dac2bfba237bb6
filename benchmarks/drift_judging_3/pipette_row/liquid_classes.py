# Liquid classes of the deck. Volumes in ul, times in s, speeds in ul/s.
"""Settings of the pipetting head for each liquid."""

CLASSES = {
    "aqueous": {
        "aspirate": 80.0,
        "settle": 0.6,  # time for which the tip stays in the liquid, until the vacuum of the piston is gone
        "dispense": 160.0,
        "blow_out": 8.0,
    },
    "ethanol": {
        "aspirate": 60.0,
        "settle": 0.3,
        "dispense": 200.0,
        "blow_out": 15.0,
    },
}


class LiquidClass:
    """One entry, read as attributes."""

    def __init__(self, name):
        if name not in CLASSES:
            raise KeyError("no liquid class %r, there are %s" % (name, ", ".join(sorted(CLASSES))))
        self.name = name
        self.__dict__.update(CLASSES[name])

    def stroke_time(self, volume):
        """Return the time for which the piston moves up."""
        return volume / self.aspirate

    def eject_time(self, volume):
        """Return the time for which the piston moves down, including the blow-out."""
        return (volume + self.blow_out) / self.dispense
