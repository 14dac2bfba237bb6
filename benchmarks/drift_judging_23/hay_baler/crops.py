"""Settings of the baler for each crop, from the operator's manual and two seasons."""

CROPS = {
    # bar: pressure on the walls of the channel; flake: m of a bale per stroke; per_bar: kg/m3 per bar
    "hay": {"bar": 92.0, "flake": 0.055, "per_bar": 1.75},
    "straw": {"bar": 128.0, "flake": 0.06, "per_bar": 1.0},
    "lucerne": {"bar": 74.0, "flake": 0.05, "per_bar": 2.1},
    "haylage": {"bar": 45.0, "flake": 0.04, "per_bar": 3.2},
}


def settings(crop):
    """Return the settings of a crop; unknown ones are baled like hay."""
    return CROPS.get(crop, CROPS["hay"])


def expected_density(crop, bar):
    """Return the density of a bale in kg/m3 that was pressed with some pressure."""
    return settings(crop)["per_bar"] * bar
