"""Sharp GP2Y0A02 on the analogue board."""


def volts(raw):
    return raw * 5.0 / 1023.0


def metres(raw):
    """Distance by the curve of the data sheet, 0.2 to 1.5 m."""
    u = volts(raw)
    if u < 0.42:
        return 1.5
    return 0.6 * u**-1.1


def median(values):
    ordered = sorted(values)
    return ordered[len(ordered) // 2]
