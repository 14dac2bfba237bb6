"""Settings of the wind tunnel."""


class Settings(object):
    period = 0.1  # s
    density = 1.19  # kg/m3
    dp_share = 0.3
    drive_per_speed = 0.04
    kp = 0.015
    ki = 0.02
    trim_max = 0.35
    slew = 0.02  # of the drive, in one period
    band = 0.012  # of the goal
    settle_count = 15
    hold_count = 20
