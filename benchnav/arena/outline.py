"""Outlines of bodies that are not discs, for pictures."""

import math

import numpy as np

from benchnav.arena.agent_bodies import AgentBodies
from benchnav.arrays import FloatArray

_ARC = 8  # pieces of a rounded corner


def outline(agents: AgentBodies, a: int) -> FloatArray | None:
    """Return the outline (V, 2) [m] of body a about its centre, heading along +x; None: a disc."""
    r = float(agents.rounding[a])
    if r == 0.0:
        return None
    x, y = float(agents.half_length[a]) - r, float(agents.half_width[a]) - r
    angles = np.linspace(0.0, 0.5 * math.pi, _ARC + 1)
    corners = []
    for k, (cx, cy) in enumerate(((x, y), (-x, y), (-x, -y), (x, -y))):
        turned = angles + 0.5 * math.pi * k
        corners.append(np.stack([cx + r * np.cos(turned), cy + r * np.sin(turned)], axis=1))
    return np.concatenate(corners)


def placed(points: FloatArray, position: FloatArray, heading: float) -> FloatArray:
    """Return points (V, 2) turned by ``heading`` [rad] and moved to ``position`` (2,) [m]."""
    c, s = math.cos(heading), math.sin(heading)
    moved: FloatArray = points @ np.array([[c, s], [-s, c]]) + position
    return moved
