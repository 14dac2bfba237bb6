"""The flow of the resurfacer's spray bar, as measured when it was new."""

import bisect

# opening of the valve (0..1) -> litres per minute of the whole bar
OPENINGS = [0.0, 0.1, 0.2, 0.35, 0.5, 0.7, 1.0]
FLOWS = [0.0, 4.1, 9.0, 17.6, 26.5, 37.0, 48.0]
BAR_SHARE = 1.0  # share of the nozzles that are fitted


def flow_at(opening):
    """Return the litres per minute at an opening."""
    i = min(len(OPENINGS) - 1, max(1, bisect.bisect_right(OPENINGS, opening)))
    low, high = OPENINGS[i - 1], OPENINGS[i]
    part = (opening - low) / (high - low)
    return BAR_SHARE * (FLOWS[i - 1] + part * (FLOWS[i] - FLOWS[i - 1]))


def opening_for(flow):
    """Return the opening for a flow in litres per minute; the inverse of flow_at."""
    wanted = flow / BAR_SHARE
    if wanted >= FLOWS[-1]:
        return 1.0
    i = max(1, bisect.bisect_right(FLOWS, wanted))
    part = (wanted - FLOWS[i - 1]) / (FLOWS[i] - FLOWS[i - 1])
    return OPENINGS[i - 1] + part * (OPENINGS[i] - OPENINGS[i - 1])
