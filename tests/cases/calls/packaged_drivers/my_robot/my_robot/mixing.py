def clip(v, top):
    return max(-top, min(v, top))


def mix(linear, angular):
    return linear - angular, linear + angular
