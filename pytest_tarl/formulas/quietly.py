"""Import rtamt without the DeprecationWarning (`typing.io`) that its parsers raise."""

import warnings

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)
    import rtamt

__all__ = ["rtamt"]
