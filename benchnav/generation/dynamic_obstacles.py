"""Draw dynamic obstacles whose whole paths are clear of static solids."""

from pathlib import Path

import numpy as np

from benchnav.arena.body import Body, Law
from benchnav.arena.solid import Kind, Solid
from benchnav.arrays import Extent, FloatArray
from benchnav.generation.clearance import Barrier, first_clear
from benchnav.generation.motion_law import draw_law, moved_law, recorded_laws, swept
from benchnav.generation.placement import FEW, NoPlaceError, draw_points, find_place
from benchnav.generation.solids import draw_solid
from benchnav.scenario.law import RecordedTrack
from benchnav.scenario.obstacle import DynamicGroup
from benchnav.scenario.sampling.region import Region
from benchnav.scenario.sampling.sampler import sample

_LAWS = 16  # laws that are tried for one obstacle


def is_fixed(group: DynamicGroup) -> bool:
    """Whether the scenario fixes the obstacles' places, so that static obstacles avoid them."""
    return group.at is not None or isinstance(group.law, RecordedTrack)


def fixed_bodies(group: DynamicGroup, folder: Path, rng: np.random.Generator) -> list[Body]:
    """Return the obstacles of a group with fixed places."""
    if isinstance(group.law, RecordedTrack):
        laws = recorded_laws(group.law, folder)
    else:
        laws = [moved_law(draw_law(group.law, rng), np.array(at)) for at in group.points]
    return [Body(_shape(group, rng), law) for law in laws]


def check_clear(bodies: list[Body], group: DynamicGroup, name: str, standing: Barrier) -> None:
    """Raise NoPlaceError unless the paths of all bodies keep the group's gap."""
    for k, body in enumerate(bodies):
        path = swept(body.law, body.solid.bounding_radius)
        if first_clear(path, np.zeros((1, 2)), standing, group.gap, whole=False) < 0:
            raise NoPlaceError(
                f"the path of {name} (number {k + 1}) is not clear of walls and static obstacles"
            )


def placed_bodies(
    group: DynamicGroup, name: str, bounds: Extent, standing: Barrier, rng: np.random.Generator
) -> list[Body]:
    """Draw the obstacles of a group with random places.

    Raises:
        NoPlaceError: an obstacle's path has no place clear of the static solids.
    """
    count = 1 if group.count is None else int(sample(group.count, rng))
    bodies = []
    for k in range(count):
        solid = _shape(group, rng)
        subject = f"the path of {name} ({group.shape.type} {k + 1} of {count})"
        bodies.append(Body(solid, _place(group, solid, bounds, standing, subject, rng)))
    return bodies


def _place(
    group: DynamicGroup,
    solid: Solid,
    bounds: Extent,
    standing: Barrier,
    subject: str,
    rng: np.random.Generator,
) -> Law:
    """Draw a law and a place that keep clear; a law without a place is drawn again."""
    region: Region = group.region  # type: ignore[assignment] # groups without it are fixed
    failure = NoPlaceError(subject)
    for _ in range(_LAWS):
        law = draw_law(group.law, rng)  # type: ignore[arg-type] # recorded tracks are fixed
        path = swept(law, solid.bounding_radius)

        def first(points: FloatArray, path: FloatArray = path) -> int:
            return first_clear(path, points, standing, group.gap, whole=False)

        try:
            place = find_place(lambda n: draw_points(region, bounds, n, rng), first, subject, FEW)
        except NoPlaceError as error:
            failure = error
            continue
        return moved_law(law, place)
    raise failure


def _shape(group: DynamicGroup, rng: np.random.Generator) -> Solid:
    return draw_solid(group.shape, group.heading, Kind.DYNAMIC, rng)
