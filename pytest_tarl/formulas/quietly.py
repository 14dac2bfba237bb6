"""Import rtamt without the DeprecationWarning (`typing.io`) of its parsers."""

import warnings

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)
    import rtamt

__all__ = ["rtamt"]
