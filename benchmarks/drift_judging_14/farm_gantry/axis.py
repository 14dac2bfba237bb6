"""Belt driven axes of the gantry: millimetres and steps of the motor."""

BELT_PITCH = 2.0  # mm, GT2
STEPS_PER_REV = 200
MICROSTEPS = 16


class Axis:
    def __init__(self, name, teeth, travel):
        self.name = name
        self.teeth = teeth
        self.travel = travel  # mm
        self.goal = 0.0  # mm

    @property
    def mm_per_step(self):
        return self.teeth * BELT_PITCH / (STEPS_PER_REV * MICROSTEPS)

    def to_steps(self, mm):
        return int(round(mm / self.mm_per_step))

    def to_mm(self, steps):
        return steps * self.mm_per_step

    def clip(self, mm):
        return min(self.travel, max(0.0, mm))

    def advance(self, target, step):
        """Move the goal towards `target` by at most `step` mm."""
        target = self.clip(target)
        self.goal += min(step, max(-step, target - self.goal))
        return self.to_steps(self.goal)
