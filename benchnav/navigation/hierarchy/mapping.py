"""Online mapping: a map for any planner, made of the agents' own observations.

Unseen space counts as free, so a plan may lead through unknown space, and the agent plans
again if the path proves blocked. This is planning with the free-space assumption (Koenig,
Tovey & Smirnov 2003). It reaches every goal that can be reached, because the map has changed
before each new plan.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from pydantic import Field

from benchnav.arena.sensing import Sensing
from benchnav.arena.solid import Kind, Solid
from benchnav.arrays import AnyArray, ByteArray, Extent, FloatArray, IntArray
from benchnav.navigation.briefing import Briefing
from benchnav.navigation.hierarchy.learned_map import GUESSED, SENSED_EDGE, learn
from benchnav.navigation.map import Map
from benchnav.navigation.navigator import Need, PluginConfig
from benchnav.navigation.observation import Observation
from benchnav.navigation.randomness.agent_streams import canonical_order
from benchnav.threads import run_rows

SIDE = 2.0  # [m] of free margin at least around the known geometry; the bounds of the map grow in
# steps of this size, so that they change rarely from plan to plan
LEAST = 4  # number of worlds below which a second thread costs more than it saves


class MappingConfig(PluginConfig):
    """Parameters of online mapping."""

    sensors: tuple[Literal["rays", "edges"], ...] = Field(
        ("rays", "edges"),
        min_length=1,
        description="edges are mapped exactly; rays, which must be thick, clear the map where they"
        " pass and, without edges, add the obstacles that stop them",
    )
    share: bool = Field(
        False, description="the agents of a world make one map together; else each makes its own"
    )


@dataclass(eq=False)
class _Row:
    """The state of one world besides the arrays."""

    briefing: Briefing
    granted: Map | None
    maps: dict[int, tuple[int, Map]] = field(default_factory=dict)  # index → (version, map)


class Mapping:
    """The maps of all rows: the granted map, if any, corrected and extended by sensor data.

    Agents and dynamic obstacles are never mapped. When the revision of the granted map
    rises, mapping starts again from it.
    """

    def __init__(self, config: MappingConfig) -> None:
        self.config = config
        self._rows: dict[int, _Row] = {}
        self._solids: dict[tuple[float, ...], Solid] = {}  # by capsule, for reuse in other maps
        self._capsules = np.zeros((0, 0, 0, 5))  # (R, M, N, 5)
        self._owner = np.zeros((0, 0, 0), np.int64)
        self._count = np.zeros((0, 0), np.int64)
        self._version = np.zeros((0, 0), np.int64)
        self._order = np.full((0, 0), -1)

    @property
    def needs(self) -> frozenset[Need]:
        """The sensors that it reads."""
        return frozenset(Need(sensor) for sensor in self.config.sensors)

    def unfit(self, sensing: Sensing) -> str:
        """Return why it cannot map with these sensors, beyond missing needs; "" if it can."""
        thin = Need.RAYS in self.needs and sensing.rays is not None and not sensing.rays.thick
        return "maps with thick rays, and those there are thin" if thin else ""

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        """Start the worlds ``rows`` (N,) from their granted maps, or from empty maps."""
        for row, briefing in zip(rows.tolist(), briefings, strict=True):
            agents = len(briefing)
            self._reserve(row + 1, agents, 0)
            self._order[row] = -1
            self._order[row, :agents] = canonical_order(briefing)
            self._begin(row, briefing, briefing.map)

    def see(self, seen: Observation) -> None:
        """Update the maps with the observation of one decision."""
        for world, row in enumerate(seen.rows.tolist()):
            map, state = seen.maps[world], self._rows[row]
            granted = state.granted
            if map is not None and granted is not None and map.revision != granted.revision:
                self._begin(row, state.briefing, map)
        worlds, agents = seen.active.shape
        radius, angle, distance, kind = self._rays(seen)
        edges, known = self._edges(seen)
        room = (distance.shape[2] + edges.shape[2]) * (agents if self.config.share else 1)
        most = int(self._count[seen.rows].max(initial=0))
        self._reserve(int(seen.rows.max(initial=-1)) + 1, agents, most + room)
        run_rows(
            learn, worlds, seen.rows, seen.active, self._order, self.config.share,
            Need.EDGES not in self.needs, seen.position, seen.heading, radius,
            angle, distance, kind, edges, known, self._capsules, self._owner, self._count,
            self._version, least=LEAST,
        )  # fmt: skip

    def _rays(self, seen: Observation) -> tuple[FloatArray, FloatArray, FloatArray, ByteArray]:
        """Return radius (B, A), angle (K,), distance and kind (B, A, K); K is 0 without rays."""
        rays = seen.rays
        if rays is None or Need.RAYS not in self.needs:
            at = (*seen.active.shape, 0)
            return np.zeros(at[:2]), np.zeros(0), np.zeros(at), np.zeros(at, np.int8)
        return rays.radius, rays.angle, rays.distance, rays.kind

    def _edges(self, seen: Observation) -> tuple[FloatArray, IntArray]:
        """Return edges (B, A, E, 8) for `learn` and counts (B, A); E is 0 if edges are not used."""
        edges = seen.edges
        if edges is None or Need.EDGES not in self.needs:
            return np.zeros((*seen.active.shape, 0, 8)), np.zeros(seen.active.shape, np.int64)
        parts = (edges.start, edges.end, edges.before, edges.after)
        return np.concatenate(parts, axis=-1), edges.count

    def doubt(self, row: int, agent: int) -> bool:
        """Remove the guesses from the agent's map. Return whether there were any."""
        m = self._place(agent)
        count = self._count[row, m]
        sure = self._owner[row, m, :count] != GUESSED
        kept = int(sure.sum())
        if kept == count:
            return False
        self._capsules[row, m, :kept] = self._capsules[row, m, :count][sure]
        self._owner[row, m, :kept] = self._owner[row, m, :count][sure]
        self._count[row, m] = kept
        self._version[row, m] += 1
        return True

    def version(self, row: int, agent: int) -> int:
        """Return the version of the agent's map, which rises with each change."""
        return int(self._version[row, self._place(agent)])

    def versions(self, row: int, agents: int) -> IntArray:
        """Return (A,), the version of each agent's map."""
        own: IntArray = self._version[row, :agents]
        return np.repeat(own[:1], agents) if self.config.share else own

    def capsules(self, row: int, agent: int) -> FloatArray:
        """Return the capsules (P, 5) of the agent's map."""
        m = self._place(agent)
        held: FloatArray = self._capsules[row, m, : self._count[row, m]]
        return held

    def map(self, row: int, agent: int) -> Map:
        """Return the agent's current map; the same object until it changes."""
        m, state = self._place(agent), self._rows[row]
        version = self.version(row, agent)
        made = state.maps.get(m)
        if made is None or made[0] != version:
            made = version, self._made(row, m)
            state.maps[m] = made
        return made[1]

    def _place(self, agent: int) -> int:
        return 0 if self.config.share else agent

    def _begin(self, row: int, briefing: Briefing, granted: Map | None) -> None:
        self._rows[row] = _Row(briefing, granted)
        solids = () if granted is None else granted.solids
        count = sum(len(solid.capsules) for solid in solids)
        self._reserve(row + 1, len(briefing), count)
        self._count[row] = count
        self._version[row] += 1
        if granted is not None and count:
            self._capsules[row, :, :count] = granted.capsules
            sizes = [len(solid.capsules) for solid in solids]
            self._owner[row, :, :count] = np.repeat(np.arange(len(solids)), sizes)

    def _made(self, row: int, m: int) -> Map:
        state, count = self._rows[row], self._count[row, m]
        held, owner = self._capsules[row, m, :count], self._owner[row, m, :count]
        kept = np.unique(owner[owner >= 0]).tolist()
        solids = [state.granted.solids[s] for s in kept] if state.granted is not None else []
        solids += [self._solid(capsule) for capsule in held[owner == SENSED_EDGE]]
        solids += [self._solid(capsule) for capsule in held[owner == GUESSED]]
        return Map(self._bounds(state, held), tuple(solids), int(self._version[row, m]))

    def _solid(self, capsule: FloatArray) -> Solid:
        key = tuple(capsule.tolist())
        solid = self._solids.get(key)
        if solid is None:
            x0, y0, x1, y1, radius = key
            if radius > 0.0:
                solid = Solid(Kind.STATIC, center=(x0, y0), radius=radius)
            else:
                solid = Solid(Kind.WALL, (np.array([(x0, y0), (x1, y1)]),))
            if len(self._solids) > 100_000:
                self._solids.clear()
            self._solids[key] = solid
        return solid

    @staticmethod
    def _bounds(state: _Row, held: FloatArray) -> Extent:
        if state.granted is not None:
            return state.granted.bounds
        corner = state.briefing.start.min(axis=0)
        places = (
            np.vstack([held[:, :2], held[:, 2:4], state.briefing.start, state.briefing.goal])
            - corner
        )
        x0, y0 = corner + SIDE * (np.floor(places.min(axis=0) / SIDE) - 1.0)
        x1, y1 = corner + SIDE * (np.ceil(places.max(axis=0) / SIDE) + 1.0)
        return float(x0), float(y0), float(x1), float(y1)

    def _reserve(self, rows: int, agents: int, capsules: int) -> None:
        """Grow the arrays to these sizes; there is one map per agent, or one per row if shared."""
        old = self._capsules.shape
        maps = min(agents, 1) if self.config.share else agents
        wide = max(self._order.shape[1], agents)
        if (
            old[0] >= rows
            and old[1] >= maps
            and old[2] >= capsules
            and wide == self._order.shape[1]
        ):
            return
        height = old[0] if old[0] >= rows else max(rows, 2 * old[0])
        at = (height, max(old[1], maps))
        deep = (*at, old[2] if old[2] >= capsules else max(capsules, 2 * old[2]))
        self._capsules = _grown(self._capsules, (*deep, 5))
        self._owner = _grown(self._owner, deep)
        self._count, self._version = _grown(self._count, at), _grown(self._version, at)
        self._order = _grown(self._order, (height, wide), -1)


def _grown(old: AnyArray, shape: tuple[int, ...], fill: float = 0) -> AnyArray:
    new = np.full(shape, fill, old.dtype)
    new[tuple(slice(n) for n in old.shape)] = old
    return new
