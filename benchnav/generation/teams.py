"""Draw starts and goals: free, separate, and connected by free space."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from benchnav.arrays import Extent, FloatArray
from benchnav.generation.clearance import POINT, Barrier, first_clear
from benchnav.generation.free_space import Space
from benchnav.generation.placement import MANY, NoPlaceError, draw_points, find_place, next_apart
from benchnav.geometry.rotation import TWO_PI, cos_sin
from benchnav.scenario.sampling.packing import lattice
from benchnav.scenario.sampling.sampler import Scalar, fixed, sample, support
from benchnav.scenario.team import (
    AntipodalGoal,
    CircleStart,
    GridStart,
    PackedStart,
    PointsGoal,
    PointsStart,
    RecordedGoal,
    RecordedStart,
    RegionStart,
    ShiftedGoal,
    Team,
)

_STARTS = 8  # starts that are tried before an agent without a goal is given up


@dataclass
class Crowd:
    """The agents placed so far."""

    start: FloatArray = field(default_factory=lambda: np.zeros((0, 2)))
    goal: FloatArray = field(default_factory=lambda: np.zeros((0, 2)))
    radius: FloatArray = field(default_factory=lambda: np.zeros(0))
    enters: FloatArray = field(default_factory=lambda: np.zeros(0))

    def add(self, start: FloatArray, goal: FloatArray, radius: float, enters: float = 0.0) -> None:
        """Add one agent."""
        self.start = np.concatenate((self.start, start[None]))
        self.goal = np.concatenate((self.goal, goal[None]))
        self.radius = np.concatenate((self.radius, (radius,)))
        self.enters = np.concatenate((self.enters, (enters,)))

    def entering(self, time: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return starts, goals (N, 2) and radii (N,) [m] of the agents that enter at ``time``."""
        chosen = self.enters == time
        if chosen.all():
            return self.start, self.goal, self.radius
        return self.start[chosen], self.goal[chosen], self.radius[chosen]


def draw_numbers(scalar: Scalar, count: int, rng: np.random.Generator) -> FloatArray:
    """Return (count,) draws."""
    if fixed(scalar):
        return np.full(count, sample(scalar, rng))
    return np.array([sample(scalar, rng) for _ in range(count)])


def place_team(
    team: Team,
    radii: FloatArray,
    enters: FloatArray,
    crowd: Crowd,
    bounds: Extent,
    spaces: Sequence[Space],
    bodies: Barrier,
    rng: np.random.Generator,
) -> None:
    """Add the agents of a team to the crowd.

    Starts and random goals are apart from those of agents that enter at the same time; starts at
    t = 0 are also clear of dynamic obstacles.

    Args:
        team: as in the scenario.
        radii: (N,) of its agents [m].
        enters: (N,) [s] when they enter.
        crowd: the agents placed before.
        bounds: of the arena [m].
        spaces: free space of this team, one for each arrangement of the static obstacles.
        bodies: dynamic obstacles at t = 0.
        rng: the team's own generator.

    Raises:
        NoPlaceError: an agent finds no start, or no goal reachable from it.
    """
    stands = lattice_of(team, bounds, len(radii))
    for k, radius in enumerate(radii):
        subject = f"of teams[{team.name}] agent {k + 1} of {len(radii)}"
        place = _Placing(
            team, k, len(radii), float(radius), float(enters[k]), crowd, bounds, spaces, bodies,
            rng, stands,
        )  # fmt: skip
        crowd.add(*place.find(subject), float(radius), float(enters[k]))


@dataclass
class GoalsTried:
    """Counts of rejected and reached goals, for the error message."""

    blocked: int = 0  # in a solid, or too close to one
    unreachable: int = 0  # free, but not joined to the start
    reached: int = 0

    def count(self, home: Sequence[int], ends: Sequence[int]) -> bool:
        """Count a goal, and return whether it is reached.

        Args:
            home: the part of each free space that contains the start.
            ends: likewise of the goal; -1: it is not free.
        """
        reached = ends == home
        if reached:
            self.reached += 1
        elif min(ends) >= 0:
            self.unreachable += 1
        else:
            self.blocked += 1
        return reached

    def explained(self, error: NoPlaceError, subject: str) -> NoPlaceError:
        """Return the error; if no goal was ever reached, one that reports this."""
        if self.reached or not self.blocked + self.unreachable:
            return error
        if self.unreachable:
            found = NoPlaceError(f"the goal {subject} is unreachable from its start")
            found.fault = "unreachable"
        else:
            found = NoPlaceError(f"the goal {subject} lies in or too close to a wall or obstacle")
            found.fault = "blocked"
        found.part = "goal"
        return found


@dataclass
class _Placing:
    """The search for one agent's start and goal."""

    team: Team
    number: int
    count: int
    radius: float
    enters: float
    crowd: Crowd
    bounds: Extent
    spaces: Sequence[Space]
    bodies: Barrier
    rng: np.random.Generator
    stands: FloatArray  # (N, 2) of a packed start; (0, 2) of any other
    ends: GoalsTried = field(default_factory=GoalsTried)

    def find(self, subject: str) -> tuple[FloatArray, FloatArray]:
        """Return a start and a goal; a start without a goal is drawn again."""
        failure = NoPlaceError(subject)
        for _ in range(_STARTS if len(self.batches) > 1 else 1):
            self.ends = GoalsTried()
            try:
                start = find_place(
                    self.starts, self.first_start, f"the start {subject}", self.batches
                )
            except NoPlaceError as error:
                raise self.ends.explained(error, subject) from None
            try:
                return start, self.goal(start, f"the goal {subject}")
            except NoPlaceError as error:
                error.part = "goal"
                failure = self.ends.explained(error, subject)
        raise failure

    @property
    def batches(self) -> tuple[int, ...]:
        """Return batch sizes; a single candidate if all candidates would be equal."""
        return (1,) if is_fixed(self.team) else MANY

    def starts(self, n: int) -> FloatArray:
        start = self.team.start
        if isinstance(start, RegionStart):
            return draw_points(start.region, self.bounds, n, self.rng)
        if isinstance(start, RecordedStart):
            raise TypeError("a recorded start must have become that of a person")
        if isinstance(start, PointsStart):
            return np.array([start.points[self.number]])
        if isinstance(start, PackedStart):
            stand = self.stands[self.number]
            return _jittered(np.repeat(stand[None], n, axis=0), start.jitter, self.rng)
        if isinstance(start, GridStart):
            row, column = divmod(self.number, start.columns)
            place = np.array(start.origin) + start.spacing * np.array([column, row])
            return _jittered(np.repeat(place[None], n, axis=0), start.jitter, self.rng)
        if start.angles == "even":
            shares = np.full(n, self.number / self.count)
        else:
            shares = self.rng.random(n)
        ways = np.array([cos_sin(TWO_PI * float(share)) for share in shares])
        return _jittered(np.array(start.center) + start.radius * ways, start.jitter, self.rng)

    def first_start(self, points: FloatArray) -> int:
        """Return the index of the first of the points (N, 2) that can be the start; -1: none."""
        gap, k = self.radius + self.team.start.separation, -1
        starts, _, radius = self.crowd.entering(self.enters)
        while True:
            k = next_apart(k + 1, points, points[0], 0.0, starts, radius, gap)
            if k < 0 or self._start_is_free(points[k : k + 1], gap):
                return k

    def _start_is_free(self, point: FloatArray, gap: float) -> bool:
        """Whether a point (1, 2), which is apart from all starts, can be the start."""
        team, crowd = self.team, self.crowd
        beside = isinstance(team.start, CircleStart) and team.start.clear_of_goals
        if beside and next_apart(0, point, point[0], 0.0, crowd.goal, crowd.radius, gap) < 0:
            return False
        if self.enters == 0.0 and first_clear(POINT, point, self.bodies, gap) < 0:
            return False
        home = self._labels(point)
        free = min(home) >= 0
        if free and isinstance(team.goal, AntipodalGoal | ShiftedGoal):
            return self._reaches(home, _bound_goals(team.goal, point))
        return free

    def _reaches(self, home: Sequence[int], goal: FloatArray) -> bool:
        """Whether a start in the free parts ``home`` is joined to a goal (1, 2)."""
        return self.ends.count(home, self._labels(goal))

    def goal(self, start: FloatArray, subject: str) -> FloatArray:
        goal = self.team.goal
        if isinstance(goal, AntipodalGoal | ShiftedGoal):
            return _bound_goals(goal, start)
        if isinstance(goal, RecordedGoal):
            raise TypeError("a recorded goal must have become that of a person")
        home = self._labels(start[None])
        if isinstance(goal, PointsGoal):
            point = np.array([goal.points[self.number]])
            return find_place(
                lambda n: point, lambda points: self._reaches(home, points) - 1, subject, (1,)
            )

        _, goals, radius = self.crowd.entering(self.enters)

        def first(points: FloatArray) -> int:
            least, k = goal.min_distance, -1
            while True:
                k = next_apart(k + 1, points, start, least, goals, radius, self.radius)
                if k < 0 or self._reaches(home, points[k : k + 1]):
                    return k

        region = goal.region
        return find_place(lambda n: draw_points(region, self.bounds, n, self.rng), first, subject)

    def _labels(self, point: FloatArray) -> list[int]:
        """Return the connected part of each free space that contains a point (1, 2)."""
        return [space.label(point) for space in self.spaces]


def _bound_goals(goal: AntipodalGoal | ShiftedGoal, starts: FloatArray) -> FloatArray:
    """Return the goals that follow from starts (…, 2)."""
    if isinstance(goal, AntipodalGoal):
        mirrored: FloatArray = 2.0 * np.array(goal.center) - starts
        return mirrored
    shifted: FloatArray = starts + np.array(goal.by)
    return shifted


def is_fixed(team: Team) -> bool:
    """Whether the scenario fixes the start of each agent."""
    start = team.start
    if isinstance(start, CircleStart):
        return start.angles == "even" and start.jitter == 0.0
    if isinstance(start, GridStart | PackedStart):
        return start.jitter == 0.0
    return isinstance(start, PointsStart)


def lattice_of(team: Team, bounds: Extent, count: int) -> FloatArray:
    """Return the places (N, 2) of a packed start before jitter; (0, 2) for any other start."""
    start = team.start
    if not isinstance(start, PackedStart):
        return np.zeros((0, 2))
    return lattice(start.front, start.spacing, start.region, bounds, count)


def fixed_places(team: Team, bounds: Extent) -> FloatArray:
    """Return the discs (N, 5) that starts and goals fill in every draw, as capsules.

    For a packed start they are enlarged by the jitter of its agents.
    """
    most = int(support(team.count)[1])
    places, shaken = lattice_of(team, bounds, most), 0.0
    if isinstance(team.start, PackedStart):
        shaken = 0.5 * np.sqrt(2.0) * team.start.jitter
    elif is_fixed(team) and (fixed(team.count) or not isinstance(team.start, CircleStart)):
        empty_crowd = Crowd()
        unused = np.random.default_rng(0)  # nothing is drawn: every place is fixed
        empty = Barrier(np.zeros((0, 5)), np.zeros(1, np.int64), np.zeros(0, np.bool_))
        for k in range(most):
            search = _Placing(
                team, k, most, 0.0, 0.0, empty_crowd, bounds, (), empty, unused, places[:0]
            )
            places = np.vstack([places, search.starts(1)])
    if isinstance(team.goal, AntipodalGoal | ShiftedGoal):
        places = np.vstack([places, _bound_goals(team.goal, places)])
    if isinstance(team.goal, PointsGoal):
        places = np.vstack([places, np.array(team.goal.points)[:most]])
    radius = np.full((len(places), 1), team.outer_radius[1] + shaken)
    return np.hstack([places, places, radius])


def _jittered(points: FloatArray, jitter: float, rng: np.random.Generator) -> FloatArray:
    if jitter == 0.0:
        return points
    moved: FloatArray = points + jitter * (rng.random(points.shape) - 0.5)
    return moved
