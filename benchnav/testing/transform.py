"""Transform an episode: move it, turn it, or reorder its agents.

No metric may depend on these changes. A turn by a right angle keeps rectangles (bounds,
measurement area) rectangles. Other angles are for worlds without a measurement area; the
new bounds are the bounding box of the turned bounds.
"""

from dataclasses import fields, replace
from typing import Any

import numpy as np

from benchnav.arena.agents import Agents, Dynamics
from benchnav.arena.body import Body, Law, LawKind
from benchnav.arena.solid import Kind, Solid
from benchnav.arena.world import World
from benchnav.arrays import Extent, FloatArray, IntArray
from benchnav.episode.episode import Episode


def moved(episode: Episode, angle: float, offset: tuple[float, float]) -> Episode:
    """Turn an episode about the origin by ``angle`` [rad], then move it by ``offset`` [m]."""
    return _Motion(angle, offset).episode(episode)


def reordered(episode: Episode, order: IntArray) -> Episode:
    """Return the episode with agent ``order[n]`` as agent n."""
    world = episode.world
    picked = {f.name: getattr(world.agents, f.name)[order] for f in fields(Agents)}
    place = np.argsort(order)
    contacts = episode.contacts
    agent = place[contacts.agent]
    partner = contacts.partner.copy()
    others = contacts.kind == Kind.AGENT
    partner[others] = place[partner[others]]
    rows = np.lexsort((contacts.start, agent))
    rest = ["kind", "start", "end", "penetration", "closing_speed", "charged"]
    return replace(
        episode,
        world=replace(world, agents=Agents(**picked)),
        contacts=replace(
            contacts, agent=agent[rows], partner=partner[rows],
            **{name: getattr(contacts, name)[rows] for name in rest},
        ),
        arrival=episode.arrival[order],
        **{name: getattr(episode, name)[:, order] for name in _PER_AGENT},
    )  # fmt: skip


_PER_AGENT = ["position", "heading", "status", "requested", "executed"]


class _Motion:
    def __init__(self, angle: float, offset: tuple[float, float]) -> None:
        quarter = round(angle / (0.5 * np.pi))
        exact = abs(angle - quarter * 0.5 * np.pi) < 1e-12
        c, s = [(1, 0), (0, 1), (-1, 0), (0, -1)][quarter % 4] if exact else _cosine(angle)
        self.angle, self.offset, self.exact = angle, np.array(offset), exact
        self.matrix = np.array([[c, -s], [s, c]], float)

    def turn(self, vectors: FloatArray) -> FloatArray:
        """Return the turned directions (…, 2)."""
        turned: FloatArray = vectors @ self.matrix.T
        return turned

    def place(self, points: FloatArray) -> FloatArray:
        """Return the turned and moved points (…, 2)."""
        placed: FloatArray = self.turn(points) + self.offset
        return placed

    def box(self, bounds: Extent) -> Extent:
        x0, y0, x1, y1 = bounds
        corners = self.place(np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]], float))
        low, high = corners.min(axis=0), corners.max(axis=0)
        return float(low[0]), float(low[1]), float(high[0]), float(high[1])

    def solid(self, solid: Solid) -> Solid:
        center = self.place(np.array(solid.center))
        return replace(
            solid,
            loops=tuple(self.place(loop) for loop in solid.loops),
            center=(float(center[0]), float(center[1])),
        )

    def body(self, body: Body) -> Body:
        about = _Motion(self.angle, (0.0, 0.0))
        law = body.law
        points = self.place(law.points)
        if law.kind == LawKind.CIRCLE:
            points[1] = law.points[1] + (0.0, self.angle)
        return replace(
            body, solid=about.solid(body.solid),
            law=Law(law.kind, law.times, points, law.periodic, law.phase),
        )  # fmt: skip

    def heading(self, heading: FloatArray) -> FloatArray:
        turned: FloatArray = np.remainder(heading + self.angle + np.pi, 2.0 * np.pi) - np.pi
        return turned

    def world(self, world: World) -> World:
        area = world.measurement_area
        if area is not None and not self.exact:
            raise ValueError("A world with a measurement area turns by right angles only.")
        agents = replace(
            world.agents, start=self.place(world.agents.start), goal=self.place(world.agents.goal),
            heading=self.heading(world.agents.heading),
        )  # fmt: skip
        stale = world.stale_solids
        return replace(
            world, agents=agents, bounds=self.box(world.bounds),
            solids=tuple(self.solid(s) for s in world.solids),
            bodies=tuple(self.body(b) for b in world.bodies),
            stale_solids=None if stale is None else tuple(self.solid(s) for s in stale),
            measurement_area=None if area is None else self.box(area),
        )  # fmt: skip

    def episode(self, episode: Episode) -> Episode:
        planar = (episode.world.agents.dynamics == int(Dynamics.HOLONOMIC))[None, :, None]

        def command(values: FloatArray) -> Any:
            return np.where(planar, self.turn(values), values)

        return replace(
            episode, world=self.world(episode.world), position=self.place(episode.position),
            heading=self.heading(episode.heading), requested=command(episode.requested),
            executed=command(episode.executed), body_position=self.place(episode.body_position),
        )  # fmt: skip


def _cosine(angle: float) -> tuple[float, float]:
    return float(np.cos(angle)), float(np.sin(angle))
