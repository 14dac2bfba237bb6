"""Throw distances of the water monitor at 8 bar, as measured in the yard on a calm day."""

THROWS = (
    # distance in m, elevation in degrees
    (0.0, 0.0),
    (10.0, 4.8),
    (20.0, 9.7),
    (30.0, 15.0),
    (40.0, 20.9),
    (50.0, 28.2),
    (58.0, 37.6),
)


def elevation(distance):
    """Return the elevation for a distance, interpolated linearly in the table."""
    for (d0, e0), (d1, e1) in zip(THROWS, THROWS[1:]):
        if distance <= d1:
            return e0 + (e1 - e0) * (distance - d0) / (d1 - d0)
    return THROWS[-1][1]
