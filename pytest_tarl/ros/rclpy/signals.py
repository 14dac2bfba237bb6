"""`rclpy.signals`: options for signal handlers, which the in-process ROS never installs."""

from __future__ import annotations

from enum import Enum


class SignalHandlerOptions(Enum):
    """The signals on which rclpy would shut down its contexts."""

    NO = 0
    SIGINT = 1
    SIGTERM = 2
    ALL = 3


def install_signal_handlers(options: SignalHandlerOptions = SignalHandlerOptions.ALL) -> None:
    """Do nothing: signals belong to pytest."""


def get_current_signal_handlers_options() -> SignalHandlerOptions:
    """Return NO: no handler is installed."""
    return SignalHandlerOptions.NO


def uninstall_signal_handlers() -> None:
    """Do nothing: no handler is installed."""
