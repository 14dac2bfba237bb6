LIMITS = {"height": 1.0}


def limited(name, value):
    return min(value, LIMITS[name])
