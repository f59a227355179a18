"""Common sensors, to find some that a navigator accepts (`Navigator.unfit`)."""

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import product

from benchnav.arena.sensing import EdgeSensor, NeighbourSensor, RaySensor, Sensing
from benchnav.errors import BenchnavError
from benchnav.generation.build import sensing_of
from benchnav.navigation.navigator import Navigator
from benchnav.scenario.catalogue import find, names
from benchnav.testing.scenes import SENSING, USUAL

COUNTS = (*range(1, 65), 72, 90, 100, 120, 128, 180, 181, 256, 270, 360, 361, 512, 720, 1080, 1081)
FANS = (math.pi, 2.0 * math.pi, 0.5 * math.pi, 1.5 * math.pi, 2.0 / 3.0 * math.pi)  # [rad]
RANGES = (8.0, 6.0, 10.0, 5.0, 4.0, 3.0, 3.5, 12.0, 15.0, 20.0, 30.0)  # [m]


def accepted(navigator: Navigator) -> Sensing | None:
    """Return the first sensing that the navigator accepts, usual ones first; None if none."""
    return next((sensing for sensing in _sensings() if not navigator.unfit(sensing)), None)


def _sensings() -> Iterator[Sensing]:
    yield from (SENSING, USUAL)
    for count, fan, thick, range_ in product(COUNTS, FANS, (True, False), RANGES):
        yield replace(USUAL, rays=RaySensor(count, fan, range_, thick))
    for count, range_ in product(COUNTS, RANGES):
        yield replace(USUAL, neighbours=NeighbourSensor(count, range_))
        yield replace(USUAL, edges=EdgeSensor(count, range_))
    yield replace(USUAL, occlusion=False)
    yield from _of_scenarios()


def _of_scenarios() -> Iterator[Sensing]:
    """Yield the sensings of the installed scenarios."""
    for name in names():
        try:
            yield sensing_of(find(name))
        except BenchnavError:  # a broken scenario is not an error of the navigator
            continue
