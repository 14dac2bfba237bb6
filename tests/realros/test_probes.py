"""The stand-in answers as the real ROS does, whose answers are on file; where it is installed, they are asked again."""

from __future__ import annotations

import pytest

from tests.realros.probes.running import LIBRARIES, answers, expected, installed, probes

ALL = [
    pytest.param(probe, id=f"{generation}-{probe.stem}")
    for generation in LIBRARIES
    for probe in probes(generation)
]


@pytest.mark.parametrize("probe", ALL)
def test_the_stand_in_answers_as_the_real_ros(probe) -> None:  # type: ignore[no-untyped-def]
    assert answers(probe, "embedded") == expected(probe.parent.name)[probe.stem]


@pytest.mark.parametrize("probe", ALL)
def test_the_real_ros_still_answers_so(probe) -> None:  # type: ignore[no-untyped-def]
    if not installed(probe.parent.name):
        pytest.skip(f"{LIBRARIES[probe.parent.name]} is not installed here")
    assert answers(probe, "real") == expected(probe.parent.name)[probe.stem]
