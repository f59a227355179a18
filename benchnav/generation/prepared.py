"""The parts that all draws of a scenario share, computed once."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path

import numpy as np

from benchnav.arena.body import Body
from benchnav.arena.mesh import Mesh
from benchnav.arena.solid import Kind, Solid
from benchnav.arrays import FloatArray
from benchnav.generation.clearance import Barrier, barrier
from benchnav.generation.free_space import JoinedSpace, PartedSpace, Space
from benchnav.generation.layout import draw_layout
from benchnav.generation.motion_law import swept
from benchnav.generation.recorded_people import read_people
from benchnav.generation.solids import bounds_wall, draw_solid, draw_wall, is_convex
from benchnav.generation.teams import fixed_places
from benchnav.scenario.files.track_file import Track
from benchnav.scenario.scenario import Scenario

_KEPT = 64  # scenarios


@dataclass(frozen=True)
class Structure:
    """The walls of one draw."""

    solids: tuple[Solid, ...]
    meshes: tuple[Mesh, ...]
    wall: Barrier


@dataclass
class Prepared:
    """A scenario and the parts that its draws share."""

    scenario: Scenario
    fixed_walls: bool  # equal in every draw
    fixed_statics: bool  # static obstacles, too, are equal in every draw
    clearance: float  # [m] all convex solids are farther apart than this; 0: unknown
    discs: FloatArray  # (N, 5) of fixed starts and goals
    people: tuple[Track, ...] = ()  # of its recording
    _structure: Structure | None = None
    _spaces: dict[float, Space] = field(default_factory=dict)

    def structure(self, stream: Callable[[], np.random.Generator]) -> Structure:
        """Return the walls of a draw; ``stream`` returns their generator."""
        if self._structure is not None:
            return self._structure
        structure = _draw_structure(self.scenario, stream())
        if self.fixed_walls:
            self._structure = structure
        return structure

    def space(self, structure: Structure, solids: Barrier, radius: float) -> Space:
        """Return the free space among ``solids`` for a disc of ``radius`` [m]."""
        if 2.0 * radius < self.clearance:
            return JoinedSpace(solids, radius)
        known = self._spaces.get(radius)
        if known is None:
            scenario = self.scenario
            known = PartedSpace(solids, scenario.bounds, scenario.walled, radius)
            if self.fixed_walls and self.fixed_statics:
                self._spaces[radius] = known
        return known

    def fixed_barrier(self, bodies: Sequence[Body]) -> Barrier:
        """Return fixed starts, goals and tracks as a barrier."""
        paths = [swept(body.law, body.solid.bounding_radius) for body in bodies]
        discs = np.vstack([self.discs, *paths])
        return Barrier(discs, np.arange(len(discs) + 1), np.zeros(len(discs), np.bool_))


@dataclass(frozen=True, eq=False)
class _ScenarioKey:
    """A scenario as a cache key: equal to another if both draw the same worlds."""

    scenario: Scenario

    @property
    def key(self) -> tuple[str, Path]:
        return self.scenario.hash, self.scenario.folder

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _ScenarioKey) and self.key == other.key

    def __hash__(self) -> int:
        return hash(self.key)


def prepare(scenario: Scenario) -> Prepared:
    """Return the shared parts of ``scenario``; cached for the most recent scenarios."""
    return _prepared(_ScenarioKey(scenario))


@lru_cache(maxsize=_KEPT)  # not a module table, which a navigator could read
def _prepared(key: _ScenarioKey) -> Prepared:
    scenario = key.scenario
    return Prepared(
        scenario,
        scenario.layout is None and all(wall.fixed for wall in scenario.walls),
        all(group.fixed for group in scenario.static),
        _clearance(scenario),
        np.vstack([fixed_places(team, scenario.bounds) for team in scenario.teams]),
        read_people(scenario),
    )


def _clearance(scenario: Scenario) -> float:
    """Return the smallest gap between any two solids, if they are convex and randomly placed."""
    if scenario.layout is not None or scenario.walls or not scenario.walled:
        return 0.0
    least = float("inf")
    for group in scenario.static:
        shape = draw_solid(group.shape, 0.0, Kind.STATIC, np.random.default_rng(0), scenario.folder)
        if group.at is not None or not is_convex(shape):
            return 0.0
        least = min(least, group.gap)
    return least


def _draw_structure(scenario: Scenario, rng: np.random.Generator) -> Structure:
    solids = [bounds_wall(scenario.bounds)] if scenario.walled else []
    if scenario.layout is not None:
        solids += draw_layout(scenario.layout, scenario.bounds, rng)
    meshes = []
    standing = [(wall, place) for wall in scenario.walls for place in wall.places]
    for wall, place in standing:
        parts, mesh = draw_wall(wall, place, scenario.folder, rng)
        solids += parts
        if mesh is not None:
            meshes.append(mesh)
    return Structure(tuple(solids), tuple(meshes), barrier(solids))
