"""Eccentric screw pump of the glue gun."""

ML_PER_REV = 0.60  # from the data sheet of the stator
MAX_RPM = 900.0
MIN_RPM = 6.0


class Pump:
    def __init__(self, slew=4000.0):
        self.slew = slew  # rpm/s
        self.rpm = 0.0

    def command(self, flow, dt):
        """Return the speed in rpm for a flow in ml/s."""
        wanted = 60.0 * flow / ML_PER_REV
        wanted = min(wanted, MAX_RPM)
        if wanted < MIN_RPM:
            wanted = 0.0
        step = self.slew * dt
        self.rpm += max(-step, min(step, wanted - self.rpm))
        return self.rpm

    def stop(self):
        self.rpm = 0.0
        return self.rpm
