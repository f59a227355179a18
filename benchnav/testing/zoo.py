"""Synthetic episodes for the checks of metrics, by name."""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from benchnav.arena.agents import Role
from benchnav.arena.body import Body, Law, LawKind
from benchnav.arena.solid import Kind, Solid
from benchnav.arena.world import ContactRule
from benchnav.episode.episode import Episode
from benchnav.testing.episodes import (
    RULES,
    Hit,
    Setting,
    Walk,
    box,
    circle,
    minimum_jerk,
    record,
    resampled,
    room,
    stop_and_go,
    straight,
    wave,
)

ENDS = replace(RULES, contact=ContactRule.END)
ROOM = (-12.0, -8.0, 12.0, 8.0)
AREA = (-3.0, -2.5, 3.0, 2.5)
EVERY_HIT = tuple(
    Hit(start, 0.5, kind, partner)
    for start, kind, partner in [
        (2.0, Kind.WALL, 0), (3.0, Kind.STATIC, 1), (4.0, Kind.DYNAMIC, -1), (5.0, Kind.AGENT, 1),
    ]
)  # fmt: skip


@dataclass(frozen=True)
class Scene:
    """Walks in a setting."""

    walks: tuple[Walk, ...]
    setting: Setting

    def episode(self, factor: int = 1) -> Episode:
        """Return the episode, recorded with ``factor`` times as many decisions."""
        return resampled(self.walks, self.setting, factor)


def _mover() -> tuple[Body, Setting]:
    """Return a disc that crosses the room from bottom to top and back, and its setting."""
    law = Law(LawKind.TRACK, np.array([0.0, 10.0]), np.array([[-6.0, -5.0], [-6.0, 5.0]]))
    body = Body(Solid(Kind.DYNAMIC, radius=0.4), law)
    path = straight((-6.0, -5.0), (0.0, 1.0))
    return body, Setting(
        horizon=12.0, bounds=ROOM, solids=(room(ROOM), box((0.0, 6.0), 1.0, 1.0)), bodies=(body,),
        body_paths=(path,), budget=2e-3,
    )  # fmt: skip


def smooth() -> Scene:
    """Return five kinds of smooth walks: two teams, both roles, hits, one background agent."""
    _, setting = _mover()
    walks = (
        Walk(straight((-9.0, 0.4), (1.0, 0.0)), (0.0, 0.4), team=0),
        Walk(straight((1.0, -0.6), (-1.1, 0.0)), (-8.0, -0.6), hits=(Hit(3.0),), team=0),
        Walk(circle((4.0, 0.0), 2.0, 1.0, np.pi), (6.0, 0.05), role=Role.FOLLOWER, team=1),
        Walk(wave((-9.0, -4.0), 0.9, 0.8, 6.0), (0.0, -4.0), role=Role.FOLLOWER, team=1),
        Walk(minimum_jerk((9.0, 5.0), (2.0, 5.0), 11.0), (2.0, 5.0), role=Role.FOLLOWER, team=1),
        Walk(stop_and_go((3.0, -5.0), 0.6, 4.0), (40.0, -5.0), driver=1),
    )
    return Scene(walks, setting)


def crowd() -> Scene:
    """Return two streams that meet in a measurement area, which defines density and flow."""
    setting = Setting(horizon=10.0, bounds=ROOM, solids=(room(ROOM),), area=AREA)
    lanes = np.linspace(-1.7, 1.7, 5)
    east = [Walk(stop_and_go((-4.0, y), 0.9, 4.0), (4.0, y), 0.15, team=0) for y in lanes]
    west = [
        Walk(straight((4.0, y + 0.425), (-0.8, 0.0)), (-3.9, y + 0.425), 0.15, team=1)
        for y in lanes
    ]
    return Scene((*east, *west), setting)


def idle() -> Episode:
    """Return an episode of an agent that never moves, with hits of all kinds and a near agent."""
    _, setting = _mover()
    far = (9.0, 0.0)
    walks = (
        Walk(straight((-8.0, 0.0), (0.0, 0.0)), far, hits=EVERY_HIT),
        Walk(lambda t: np.array([-8.0, 2.03]) + np.outer(np.minimum(t, 1.48), [0.0, -1.0]), far,
             driver=1),
    )  # fmt: skip
    return record(walks, setting)


def failing() -> Episode:
    """Return the episode `idle` with an agent whose navigator failed at once."""
    episode = idle()
    status = episode.status.copy()
    status[1:, 0] = 3
    return replace(episode, status=status, failure="ValueError: no")


def crashing() -> Episode:
    """Return an episode of an agent whose attempt ends at a wall after two seconds."""
    setting = Setting(bounds=ROOM, solids=(room(ROOM),), rules=ENDS)
    walk = Walk(straight((-9.7, 0.0), (-1.0, 0.0)), (9.0, 0.0), hits=(Hit(2.0, 0.0),), ends=2.0)
    return record((walk,), setting)


def errand(crashes: bool) -> Episode:
    """Return an episode of an agent that passes standing agents and arrives, or hits a box."""
    solids = (room(ROOM), box((-5.2, 0.0), 1.0, 1.0)) if crashes else (room(ROOM),)
    hits, ends = ((Hit(2.0, 0.0, Kind.STATIC, 1),), 2.0) if crashes else ((), None)
    setting = Setting(bounds=ROOM, solids=solids, rules=ENDS)
    walks = (
        Walk(wave((-8.0, 0.0), 1.0, 0.3, 4.0), (0.0, 0.0), hits=hits, ends=ends),
        Walk(straight((-3.0, 1.1), (0.0, 0.0)), (9.0, 1.1), driver=1),
        Walk(straight((-2.0, -1.8), (0.0, 0.0)), (9.0, -1.8), driver=1),
    )
    return record(walks, setting)


def with_company(speed: float) -> Episode:
    """Return an episode of an agent that arrives after 5 s, and a distant agent of ``speed``.

    The distant agent's speed [m/s] determines the length of the record.
    """
    bounds = (-20.0, -60.0, 20.0, 60.0)
    setting = Setting(bounds=bounds, solids=(box((0.0, 2.0), 1.0, 1.0),))
    walks = (
        Walk(wave((-3.0, 0.0), 1.0, 0.5, 2.6), (2.2, 0.0)),
        Walk(straight((-3.0, 50.0), (speed, 0.0)), (2.2, 50.0)),
    )
    return record(walks, setting)


def late() -> Episode:
    """Return an episode in which one background agent enters later, and another not at all."""
    walks = (
        Walk(wave((-8.0, 0.0), 1.0, 0.4, 6.0), (1.0, 0.0)),
        Walk(lambda t: np.array([1.0, 5.0]) + np.outer(t - 4.0, [-0.6, -0.9]), (-1.4, 1.4),
             driver=1, enters=4.0),
        Walk(straight((-6.0, 0.0), (0.0, 0.0)), (9.0, 0.0), driver=1, enters=15.0),
    )  # fmt: skip
    return record(walks, Setting(bounds=ROOM, solids=(room(ROOM),)))


@cache
def zoo() -> dict[str, Episode]:
    """Return the episodes by name. They are built once and read-only."""
    episodes = {
        "smooth": smooth().episode(), "crowd": crowd().episode(), "idle": idle(),
        "failing": failing(), "crashing": crashing(), "company": with_company(0.5),
        "errand": errand(crashes=False), "broken off": errand(crashes=True), "late": late(),
    }  # fmt: skip
    for episode in episodes.values():
        for name in ("position", "heading", "status", "requested", "executed", "body_position",
                     "arrival"):  # fmt: skip
            getattr(episode, name).setflags(write=False)
    return episodes
