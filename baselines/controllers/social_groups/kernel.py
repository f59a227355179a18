"""The forces between members of a group.

Formulas: Moussaïd et al. 2010, "The walking behaviour of pedestrian social groups and its impact
on crowd dynamics", PLoS ONE 5(4), e10047. Comments mark additions to the paper.
"""

import math
from typing import NamedTuple

from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.kernels import kernel

LEAST = 1e-9  # [m], [m/s] smaller vectors have no direction


class GroupForces(NamedTuple):
    """Parameters of the forces in a group."""

    gaze: float  # β₁ [1/s]
    attraction: float  # β₂ [m/s²]
    repulsion: float  # β₃ [m/s²]
    view_angle: float  # φ [rad] to each side that needs no turn of the head
    spacing: (
        float  # [m] between neighbours side by side; attraction begins at half of (N − 1) times it
    )
    ramp: float  # [m] over which the attraction grows to its full strength
    distance: float  # d₀ [m] between the centres of two members that repel each other


@kernel
def head_turn(vx: float, vy: float, cx: float, cy: float, view: float) -> float:
    """Return the angle α [rad] by which a head turns from velocity v so that it sees c.

    c is relative to the head; ``view`` [rad] is the angle to each side that needs no turn.
    """
    angle = math.atan2(abs(vx * cy - vy * cx), vx * cx + vy * cy)
    return max(angle - view, 0.0)


@kernel
def group_force(
    low: int, high: int, agents: int, active: BoolArray, here: FloatArray, moving: FloatArray,
    companions: IntArray, forces: GroupForces, answer: FloatArray,
) -> None:  # fmt: skip
    """Add the accelerations [m/s²] by the group to rows low … high - 1 of ``answer`` (N, 2).

    Args:
        low: first row.
        high: one past the last row.
        agents: rows of each world.
        active: (N,) rows to write; members that are not active do not count.
        here: (N, 2) [m].
        moving: (N, 2) velocity [m/s].
        companions: (N, C) 1 + the index in its world of each other member; 0: none.
        forces: parameters.
        answer: (N, 2).
    """
    for i in range(low, high):
        if not active[i]:
            continue
        first = i - i % agents
        size, cx, cy, fx, fy = 1, 0.0, 0.0, 0.0, 0.0  # c: sum of the members relative to i
        for k in range(companions.shape[1]):
            if companions[i, k] == 0 or not active[first + companions[i, k] - 1]:
                continue
            j = first + companions[i, k] - 1
            dx, dy = here[j, 0] - here[i, 0], here[j, 1] - here[i, 1]
            apart = math.sqrt(dx * dx + dy * dy)
            if LEAST < apart < forces.distance:
                fx -= forces.repulsion * dx / apart
                fy -= forces.repulsion * dy / apart
            size, cx, cy = size + 1, cx + dx, cy + dy
        if size == 1:
            continue
        cx, cy = cx / size, cy / size
        away = math.sqrt(cx * cx + cy * cy)
        if away > LEAST:
            vx, vy = moving[i, 0], moving[i, 1]
            turn = forces.gaze * head_turn(vx, vy, cx, cy, forces.view_angle)
            fx, fy = fx - turn * vx, fy - turn * vy
            excess = away - 0.5 * forces.spacing * (size - 1)
            # an addition: in the paper the force is whole as soon as the excess is positive
            share = min(excess / forces.ramp, 1.0) if excess > 0.0 else 0.0
            fx += share * forces.attraction * cx / away
            fy += share * forces.attraction * cy / away
        answer[i, 0] += fx
        answer[i, 1] += fy
