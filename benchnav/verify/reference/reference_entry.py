"""The entry of agents in the reference simulator: when their time has come and there is room."""

import math
from typing import TYPE_CHECKING

import numpy as np

from benchnav.episode.episode import Status
from benchnav.verify.reference.reference_geometry import inside, nearest

if TYPE_CHECKING:
    from benchnav.verify.reference.reference_simulator import Twin

SOON = 1e-9  # [s] a time of entry is reached this much earlier
TIGHT = 1e-9  # [m] rounding may decide whether a start is free


def admit(twin: "Twin") -> None:
    """Let the waiting agents enter that may, by their times, then by their indices."""
    now, enters = twin.steps * twin.world.clock.dt, twin.world.agents.enters
    waiting = np.flatnonzero((twin.status == int(Status.WAITING)) & (enters <= now + SOON))
    for i in sorted(waiting.tolist(), key=lambda agent: (enters[agent], agent)):
        room = _room(twin, i)
        twin.doubtful |= abs(room) < TIGHT
        if room >= 0.0:
            twin.status[i] = int(Status.ACTIVE)


def _room(twin: "Twin", i: int) -> float:
    """Return the gap [m] of the circle around agent i to other agents' circles and to bodies."""
    place, radius = twin.position[i], twin.world.agents.radius
    away = np.hypot(*(twin.position - place).T) - radius - radius[i]
    gaps = [math.inf, *away[twin.present].tolist()]
    for m, body in enumerate(twin.world.bodies):
        c = twin.carried(m)
        apart = np.hypot(*(place - nearest(place, c[:, :2], c[:, 2:4])).T) - c[:, 4] - radius[i]
        gaps += apart.tolist()
        if not body.solid.is_disc and inside(place - twin.bodies[m], body.solid.loops):
            return -float(radius[i])
    return float(min(gaps))
