"""Find every flow from a subscribed topic to a published one, with the statements on its path."""

__version__ = "0.1.0"
