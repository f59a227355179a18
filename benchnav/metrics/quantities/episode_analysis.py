"""Quantities that several metrics of one episode share, computed once.

`analyse(episode)` has no visible side effects: an episode is immutable, its analysis is
cached as long as the episode exists, and callers must not modify it.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from benchnav.arena.solid import Kind
from benchnav.arena.world import World
from benchnav.arrays import BoolArray, ByteArray, FloatArray, IntArray
from benchnav.episode.episode import Contacts, Episode, Status
from benchnav.metrics.quantities.density import frame_times, voronoi_density
from benchnav.metrics.quantities.encounters import Encounters, encounters, things_of
from benchnav.metrics.quantities.footprint_gaps import shapes_of
from benchnav.metrics.quantities.lowpass import smooth_velocities
from benchnav.metrics.quantities.people import Approaches, approaches_of
from benchnav.metrics.quantities.trajectory import Trajectories, cut, entered_at, positions_at

TeamMotion = tuple[FloatArray, FloatArray, BoolArray, FloatArray]
"""Places, steps (n, N, 2) [m] and activity (n, N) of n members, and their radii (n,) [m]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Endings:
    """How the attempts of an episode end; it needs no trajectories."""

    failed: BoolArray  # (A,) its navigator failed in this episode
    active_at_end: BoolArray  # (A,) still on its way when the record ends
    arrival: FloatArray  # (A,) [s], NaN without an arrival or if its navigator failed
    contacts: Contacts

    @cached_property
    def arrived(self) -> BoolArray:
        """(A,) it arrived, and its navigator did not fail."""
        return ~np.isnan(self.arrival)

    @cached_property
    def success(self) -> BoolArray:
        """(A,) arrived, and no charged contact had started before."""
        c = self.contacts
        early = c.charged & (c.start < self.arrival[c.agent])
        hit = np.zeros(len(self.arrival), np.bool_)
        hit[c.agent[early]] = True
        return self.arrived & ~hit


def endings(episode: Episode) -> Endings:
    """Return how the attempts of an episode end."""
    failed = (episode.status == int(Status.FAILED)).any(axis=0)
    if episode.failure:
        failed = failed | episode.world.agents.evaluated
    return Endings(
        failed=failed,
        active_at_end=episode.status[-1] == int(Status.ACTIVE),
        arrival=np.where(failed, np.nan, episode.arrival),
        contacts=episode.contacts,
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class Analysis(Endings):
    """Intermediate results. It has no reference to the episode, so both can be freed."""

    world: World
    trajectories: Trajectories
    body_position: FloatArray  # (T+1, M, 2) [m]
    heading: FloatArray  # (T+1, A) [rad]
    status: ByteArray  # (T+1, A) of Status
    decision: FloatArray  # (T,) [s]

    @cached_property
    def charged(self) -> FloatArray:
        """(6, A) number of charged contacts with each `Kind` of partner."""
        c, agents = self.contacts, len(self.arrival)
        place = c.kind[c.charged].astype(np.int64) * agents + c.agent[c.charged]
        count = np.bincount(place, minlength=len(Kind) * agents)
        return count.reshape(len(Kind), agents).astype(np.float64)

    @cached_property
    def geodesic(self) -> FloatArray:
        """(A,) [m] shortest way of each disc to its goal; NaN if there is none, or walls move."""
        agents = self.world.agents
        return self.ways_to_goal(np.arange(len(agents)), agents.start)

    def ways_to_goal(self, chosen: IntArray, place: FloatArray) -> FloatArray:
        """Return the shortest ways (N,) [m] of ``chosen`` agents from ``place`` (N, 2) [m].

        NaN if there is none, or walls move.
        """
        agents = self.world.agents
        if self.world.relocates:
            return np.full(len(chosen), np.nan)
        from benchnav.geometry.geodesic import geodesic_lengths

        solids = [np.zeros((0, 5)), *(solid.capsules for solid in self.world.solids)]
        lengths = geodesic_lengths(
            np.vstack(solids), place, agents.goal[chosen], agents.radius[chosen],
            self.world.rules.goal_tolerance,
        )  # fmt: skip
        return np.where(np.isfinite(lengths), lengths, np.nan)

    @cached_property
    def density(self) -> FloatArray:
        """(N,) [1/m²] Voronoi density at 1 Hz; (0,) without a measurement area."""
        return voronoi_density(self.world, self.trajectories)

    @cached_property
    def decision_per_agent(self) -> FloatArray:
        """(N,) [s] time per decision and active agent, ascending."""
        active = self.status == int(Status.ACTIVE)
        driven = active[:-1, self.world.agents.evaluated].sum(axis=1)
        count = driven[: len(self.decision)]
        return np.sort(self.decision[count > 0] / count[count > 0])

    @cached_property
    def group_motion(self) -> tuple[FloatArray, FloatArray, BoolArray]:
        """At 2 Hz: places, steps of the next 0.25 s (A, N, 2) [m], agents on their way (A, N)."""
        times = frame_times(self.trajectories)
        place = positions_at(self.trajectories, times)
        step = positions_at(self.trajectories, times + 0.25) - place
        active = times[None] < self.trajectories.end[:, None]
        return place, step, active & entered_at(self.trajectories, times)

    def teams_together(self, members: BoolArray) -> list[TeamMotion]:
        """Return the `group_motion` of each team, while two or more members are on their way.

        Teams in which this never happens are left out. ``members`` (A,) selects the agents.
        """
        key = members.tobytes()
        if key not in self._together:
            place, step, active = self.group_motion
            agents, teams = self.world.agents, []
            for team in sorted(set(agents.team[members].tolist())):
                own = np.flatnonzero(members & (agents.team == team))
                together = active[own].sum(axis=0) > 1
                if together.any():
                    now = own[:, None], np.flatnonzero(together)
                    teams.append((place[now], step[now], active[now], agents.radius[own]))
            self._together[key] = teams
        return self._together[key]

    @cached_property
    def _together(self) -> dict[bytes, list[TeamMotion]]:
        return {}

    @cached_property
    def smooth_velocities(self) -> dict[int, FloatArray]:
        """Agent → velocity (N, 2) [m/s] at a fixed rate, low-passed by `lowpass`.

        For agents that arrive and move by at least their radius.
        """
        agents = np.flatnonzero(self.arrived & self.trajectories.moved)
        found = smooth_velocities(self.trajectories, agents) if len(agents) else []
        return dict(zip(agents.tolist(), found, strict=True))

    @cached_property
    def encounters(self) -> Encounters:
        """The smallest distances between agents and obstacles."""
        things = things_of(self.world, self.body_position)
        agents, shapes = self.world.agents, None
        if (agents.rounding > 0.0).any():
            shapes = shapes_of(agents), np.ascontiguousarray(self.heading.T)
        return encounters(self.trajectories, agents.radius, things, shapes)

    @cached_property
    def approaches(self) -> Approaches:
        """How the evaluated agents meet people."""
        return approaches_of(self.world, self.trajectories, self.body_position)


# The attribute of an episode. A global cache here would give navigators access to episodes.
_KEPT = "_analysis"


def keep(episode: Episode, analysis: Analysis) -> None:
    """Let `analyse` return this analysis, of trajectories that no simulation gave."""
    vars(episode)[_KEPT] = analysis


def analyse(episode: Episode) -> Analysis:
    """Return the analysis of an episode: the same object in every call."""
    found: Analysis | None = vars(episode).get(_KEPT)
    if found is None:
        ends = endings(episode)
        found = Analysis(
            failed=ends.failed, active_at_end=ends.active_at_end, arrival=ends.arrival,
            contacts=ends.contacts, world=episode.world, trajectories=cut(episode),
            body_position=episode.body_position, heading=episode.heading, status=episode.status,
            decision=episode.timings.decision,
        )  # fmt: skip
        keep(episode, found)
    return found
