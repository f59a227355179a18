"""Draw static obstacles one after another, each clear of the solids already placed."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from benchnav.arena.body import Body, Law, LawKind
from benchnav.arena.solid import Kind, Solid
from benchnav.arrays import Extent, FloatArray
from benchnav.generation.clearance import Barrier, added, first_clear, joined
from benchnav.generation.placement import NoPlaceError, directions, draw_points, find_place, within
from benchnav.generation.solids import draw_solid
from benchnav.scenario.obstacle import StaticGroup
from benchnav.scenario.sampling.region import Region
from benchnav.scenario.sampling.sampler import sample

ARRANGEMENTS = 50  # of old places that are tried before the world is drawn again
Stream = Callable[[int], np.random.Generator]  # group → its generator


@dataclass(frozen=True)
class Piece:
    """One static obstacle: its shape, its place, and its earlier or later place."""

    shape: Solid  # about the origin
    place: FloatArray  # (2,) [m] at the start of the episode
    before: FloatArray | None = None  # (2,) [m] place before the episode
    after: FloatArray | None = None  # (2,) [m] place at the end of the episode
    when: float = 0.0  # [s] time of the relocation, once the new place is free

    @cached_property
    def solid(self) -> Solid:
        """Return the obstacle at its place at the start."""
        return self.shape.moved(self.place)

    @cached_property
    def before_solid(self) -> Solid:
        """Return the obstacle at its place before the episode."""
        return self.solid if self.before is None else self.shape.moved(self.before)

    @cached_property
    def after_solid(self) -> Solid:
        """Return the obstacle at its place at the end."""
        return self.solid if self.after is None else self.shape.moved(self.after)

    @property
    def body(self) -> Body:
        """Return the obstacle as a body that is relocated within the episode."""
        points = np.vstack([self.place, self.place if self.after is None else self.after])
        return Body(self.shape, Law(LawKind.RELOCATE, np.array([0.0, self.when]), points))


def draw_pieces(
    groups: Sequence[StaticGroup],
    bounds: Extent,
    walls: Barrier,
    keep_free: Barrier,
    stream: Stream,
    other: Stream,
    folder: Path = Path(),
) -> list[Piece]:
    """Return all static obstacles of one draw, in the order of their groups.

    Args:
        groups: as the scenario lists them.
        bounds: of the arena [m].
        walls: solids placed before anything is drawn.
        keep_free: fixed starts, goals and tracks, which sampled obstacles avoid.
        stream: returns the generator of a group, for shapes and for places at the start.
        other: returns the generator of a group, for places before the start and after it.
        folder: base of the relative names of meshes and maps.

    Raises:
        NoPlaceError: an obstacle finds no place.
        InputError: a mesh or map file is wrong.
    """
    search = _Search(bounds, keep_free, folder)
    pieces: list[list[Piece]] = []
    standing = walls
    for i, group in enumerate(groups):
        drawn, standing = search.now(group, f"static[{i}]", standing, stream(i))
        pieces.append(drawn)
    past = walls
    if any(group.was_moved for group in groups):
        for group, drawn in zip(groups, pieces, strict=True):
            for piece in () if group.was_moved else drawn:
                past = added(past, piece.solid.capsules)
    for i, group in enumerate(groups):
        name = f"static[{i}]"
        if group.relocate_at is not None:
            pieces[i], standing = search.later(group, name, pieces[i], standing, other(i))
        elif group.was_moved:
            pieces[i], past = search.before(group, name, pieces[i], past, other(i))
    return [piece for drawn in pieces for piece in drawn]


@dataclass(frozen=True)
class _Search:
    """Finds places that keep a group's gap to placed solids and to places kept free.

    Each method returns the pieces, and the barrier that includes them.
    """

    bounds: Extent
    keep_free: Barrier
    folder: Path

    def now(
        self, group: StaticGroup, name: str, standing: Barrier, rng: np.random.Generator
    ) -> tuple[list[Piece], Barrier]:
        """Draw shapes and places at the start."""
        pieces: list[Piece] = []
        count = 1 if group.count is None else int(sample(group.count, rng))
        for k in range(count if group.at is None else len(group.points)):
            shape = draw_solid(group.shape, group.heading, Kind.STATIC, rng, self.folder)
            if group.at is not None:
                place = np.array(group.points[k])
            else:
                subject = f"{name} ({group.shape.type} {k + 1} of {count})"
                place = self._place(shape, group, standing, subject, rng)
            pieces.append(Piece(shape, place))
            standing = added(standing, pieces[k].solid.capsules)
        return pieces, standing

    def later(
        self,
        group: StaticGroup,
        name: str,
        pieces: list[Piece],
        standing: Barrier,
        rng: np.random.Generator,
    ) -> tuple[list[Piece], Barrier]:
        """Add later places, clear of everything that is placed now or later."""
        result = []
        for k, piece in enumerate(pieces):
            subject = f"the new place of {name} ({group.shape.type} {k + 1} of {len(pieces)})"
            after = self._place(piece.shape, group, standing, subject, rng)
            when = 0.0 if group.relocate_at is None else sample(group.relocate_at, rng)
            result.append(replace(piece, after=after, when=when))
            standing = added(standing, result[k].after_solid.capsules)
        return result, standing

    def before(
        self,
        group: StaticGroup,
        name: str,
        pieces: list[Piece],
        past: Barrier,
        rng: np.random.Generator,
    ) -> tuple[list[Piece], Barrier]:
        """Add earlier places, clear of all other obstacles' earlier places.

        Obstacles moved by a fixed distance each have few places, and one may take another's: then
        all are drawn again, so that the world of a seed seldom depends on the distance.
        """
        for _ in range(0 if isinstance(group.moved, bool) else ARRANGEMENTS - 1):
            try:
                return self._before(group, name, pieces, past, rng)
            except NoPlaceError:
                continue
        return self._before(group, name, pieces, past, rng)

    def _before(
        self,
        group: StaticGroup,
        name: str,
        pieces: list[Piece],
        past: Barrier,
        rng: np.random.Generator,
    ) -> tuple[list[Piece], Barrier]:
        result = []
        for k, piece in enumerate(pieces):
            subject = f"the old place of {name} ({group.shape.type} {k + 1} of {len(pieces)})"
            before = self._place(piece.shape, group, past, subject, rng, away=piece.place)
            result.append(replace(piece, before=before))
            past = added(past, result[k].before_solid.capsules)
        return result, past

    def _place(
        self,
        shape: Solid,
        group: StaticGroup,
        standing: Barrier,
        subject: str,
        rng: np.random.Generator,
        away: FloatArray | None = None,
    ) -> FloatArray:
        """Find a place in the group's region, or the group's move distance from ``away`` (2,)."""
        region: Region = group.region  # type: ignore[assignment] # groups without it have `at`
        around = joined(standing, self.keep_free)

        def propose(count: int) -> FloatArray:
            if away is None or isinstance(group.moved, bool):
                return draw_points(region, self.bounds, count, rng)
            return away + group.moved * directions(count, rng)

        def first(points: FloatArray) -> int:
            if away is None:
                return first_clear(shape.capsules, points, around, group.gap)
            inside = np.flatnonzero(within(self.bounds, points))
            k = first_clear(shape.capsules, points[inside], around, group.gap)
            return int(inside[k]) if k >= 0 else -1

        return find_place(propose, first, subject)
