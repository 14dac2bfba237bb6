"""rtamt without the DeprecationWarning that its parsers raise when they are imported (`typing.io`)."""

import warnings

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)
    import rtamt

__all__ = ["rtamt"]
