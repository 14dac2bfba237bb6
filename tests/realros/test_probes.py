"""The stand-in gives the recorded results of the real ROS, and so does an installed ROS."""

from __future__ import annotations

import pytest

from tests.realros.probes.running import LIBRARIES, answers, expected, installed, probes

ALL = [
    pytest.param(probe, id=f"{generation}-{probe.stem}")
    for generation in LIBRARIES
    for probe in probes(generation)
]


@pytest.mark.parametrize("probe", ALL)
def test_the_stand_in_behaves_like_the_real_ros(probe) -> None:  # type: ignore[no-untyped-def]
    assert answers(probe, "embedded") == expected(probe.parent.name)[probe.stem]


@pytest.mark.parametrize("probe", ALL)
def test_the_real_ros_still_behaves_as_recorded(probe) -> None:  # type: ignore[no-untyped-def]
    if not installed(probe.parent.name):
        pytest.skip(f"{LIBRARIES[probe.parent.name]} is not installed here")
    assert answers(probe, "real") == expected(probe.parent.name)[probe.stem]
