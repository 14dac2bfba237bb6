"""Orders as text: "label position up|down"."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Order:
    """Where a pallet goes, and whether it is raised there."""

    label: str
    position: float
    up: bool


def parse_order(text):
    """Return the order in the text. Raises ValueError if it is none."""
    label, position, way = text.split()
    if way not in ("up", "down"):
        raise ValueError(f"{way}: neither up nor down")
    return Order(label, float(position), way == "up")
