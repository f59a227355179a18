"""The common part of the ORCA navigator and controller: limits per row, and the kernel call."""

from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache

import numpy as np
from pydantic import Field

from benchnav.arrays import AnyArray, FloatArray, IntArray
from benchnav.navigation import (
    Briefing,
    Edges,
    Neighbours,
    Observation,
    PluginConfig,
    RowTable,
    canonical_order,
)
from benchnav.threads import run_rows

from ...common.motion_limits import has_limits, limits_of
from .kernel import OWN, avoid, avoid_within_limits, prepare

LEAST_MARGIN = 1e-3  # [m] at edges: without a margin, rounding causes contacts
LEAST = 64  # with fewer agents, a second thread costs more than it saves
LEAST_BRIEF = 8192  # the same for a kernel of a few nanoseconds an agent


class OrcaConfig(PluginConfig):
    """Parameters of optimal reciprocal collision avoidance (van den Berg et al. 2011)."""

    time_horizon: float = Field(
        5.0, gt=0, description="[s] for which velocities are safe with respect to neighbours"
    )
    time_horizon_obstacle: float = Field(
        1.0, gt=0, description="[s] for which velocities are safe with respect to edges"
    )
    margin: float = Field(
        0.05, ge=0, description="[m] added to the radius of every disc, for neighbours"
    )
    edge_margin: float = Field(
        0.05,
        ge=0,
        description="[m] added to the agent's own radius, for edges; less on a narrow path",
    )
    tracking_error: float = Field(
        0.1,
        gt=0,
        description="[m] by which a body that cannot take a velocity at once may stray; its disc"
        " is enlarged by it. Used for cars, wheels and limits of acceleration; less near objects",
    )
    neighbours: int = Field(10, ge=0, description="nearest neighbours that are considered")
    perturbation: float = Field(
        0.005,
        ge=0,
        lt=1,
        description="size of a constant random error of the agent's own velocity and preferred"
        " velocity, as a share of the preferred speed; without it, agents in exact symmetry"
        " never move",
    )


class Avoidance:
    """Turns targets into velocities that avoid neighbours and edges."""

    def __init__(self, config: OrcaConfig) -> None:
        self.config = config
        self._table = RowTable()

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        """Store radii, limits and the symmetry-breaking offsets of the worlds ``rows`` (N,)."""
        for row, briefing in zip(rows, briefings, strict=True):
            count = len(briefing)
            offset = np.empty((count, 2))
            offset[canonical_order(briefing)] = 2.0 * briefing.rng.random((count, 2)) - 1.0
            own = np.empty((count, 4))
            own[:, 0] = briefing.radius
            own[:, 1] = briefing.max_speed
            own[:, 2] = briefing.preferred_speed
            own[:, 3] = briefing.dt
            limits = limits_of(briefing)
            self._table.put(
                int(row), own=own, offset=offset * self.config.perturbation, limits=limits,
                limited=has_limits(limits),
            )  # fmt: skip

    def velocity(
        self, observation: Observation, target: FloatArray, clearance: FloatArray | None = None
    ) -> FloatArray:
        """Return the velocity (B, A, 2) [m/s] near the one that leads to ``target`` (B, A, 2) [m].

        The margin at edges is at most ``clearance`` (B, A) [m], but at least `LEAST_MARGIN`.
        """
        worlds, agents = observation.active.shape
        rows = worlds * agents
        limits, offset = (
            self._table.take(name, observation.rows, agents) for name in ("own", "offset")
        )
        whole = (observation.position, observation.velocity, target, limits, offset)
        own, answer = np.empty((rows, OWN)), np.zeros((rows, 2))
        run_rows(prepare, rows, *_flat(rows, whole), own, least=LEAST_BRIEF)
        config = self.config
        edge_margin = np.empty(rows)
        edge_margin.fill(config.edge_margin)
        if clearance is not None:
            edge_margin = np.minimum(edge_margin, np.maximum(clearance.ravel(), LEAST_MARGIN))
        sensed = tuple(_sensed(observation))
        active, limited = observation.active, self._table.take("limited", observation.rows, agents)
        bounds = (
            config.neighbours, config.margin, edge_margin, 1.0 / config.time_horizon,
            1.0 / config.time_horizon_obstacle,
        )  # fmt: skip
        if limited.any():
            limits = self._table.take("limits", observation.rows, agents)
            bodies = (observation.heading, target, limits)
            run_rows(
                avoid_within_limits, rows, own, (active & limited).ravel(), *_flat(rows, bodies),
                *sensed, *bounds, config.tracking_error, answer, least=LEAST,
            )  # fmt: skip
            active = active & ~limited
        run_rows(avoid, rows, own, active.ravel(), *sensed, *bounds, answer, least=LEAST)
        return answer.reshape(worlds, agents, 2)


def _flat(rows: int, arrays: Iterable[AnyArray]) -> Iterator[AnyArray]:
    """Yield each array (B, A, …) as contiguous (rows, …)."""
    for array in arrays:
        yield array.reshape(rows, *array.shape[2:])


def _sensed(observation: Observation) -> Iterator[AnyArray]:
    """Yield neighbours and edges as kernel arguments (rows, …)."""
    shape = observation.active.shape
    rows = shape[0] * shape[1]
    near, sides = observation.neighbours or no_neighbours(*shape), observation.edges
    yield from _flat(rows, (near.position, near.velocity, near.radius, near.kind, near.count))
    yield from _no_sides(rows) if sides is None else _sides(rows, sides)


def _sides(rows: int, edges: Edges) -> tuple[AnyArray, ...]:
    ends = (edges.start, edges.end, edges.before, edges.after)
    return tuple(_flat(rows, (*ends, edges.start_convex, edges.end_convex, edges.count)))


@lru_cache(maxsize=8)  # kernels only read them
def _no_sides(rows: int) -> tuple[AnyArray, ...]:
    return _sides(rows, no_edges(1, rows))


@lru_cache(maxsize=8)
def no_neighbours(worlds: int, agents: int) -> Neighbours:
    """Return readings without any neighbour."""
    at = (worlds, agents, 0)
    return Neighbours(
        np.zeros((*at, 2)), np.zeros((*at, 2)), np.zeros(at), np.zeros(at, np.int8),
        np.zeros(at[:2], np.int64),
    )  # fmt: skip


@lru_cache(maxsize=8)  # kernels only read them
def no_edges(worlds: int, agents: int) -> Edges:
    """Return readings without any edge."""
    at = (worlds, agents, 0)
    start, end, before, after = (np.zeros((*at, 2)) for _ in range(4))
    convex = np.zeros(at, np.bool_)
    return Edges(start, end, before, after, convex, convex, np.zeros(at[:2], np.int64))
