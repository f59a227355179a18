"""The forces of the social force model, and their integration over one decision step.

Formulas and numbers of equations: Helbing and Molnár 1995, "Social force model for
pedestrian dynamics", Physical Review E 51, 4282. Positions are relative to the agent
unless noted. Comments mark additions to the paper.
"""

import math

from benchnav.arrays import FloatArray
from benchnav.geometry import nearest_on_segment
from benchnav.kernels import kernel

LEAST = 1e-3  # [m] lower bound of distances: at the foci the gradient has no limit
NONE = 1e-9  # [m] a smaller semi-minor axis counts as zero
SAME = 1e-18  # [m²] closer nearest points are one corner, found on both of its edges


@kernel
def pedestrian_force(
    rx: float, ry: float, sx: float, sy: float, strength: float, reach: float
) -> tuple[float, float]:
    """Return −∇V(b) [m/s²] at r from a pedestrian whose next step is s [m] (Eqs. 3 and 4).

    V = strength · exp(−b / reach) [m²/s²], where b is the semi-minor axis of the ellipse
    through r with foci at the pedestrian and at the end of its step:
    2b = √((|r| + |r − s|)² − |s|²).
    """
    qx, qy = rx - sx, ry - sy
    a, c = math.sqrt(rx * rx + ry * ry), math.sqrt(qx * qx + qy * qy)
    # (|r| + |r − s|)² − |s|² = 2 (|r| |r − s| + r · (r − s)), which does not cancel for long steps
    b = math.sqrt(max(0.5 * (a * c + rx * qx + ry * qy), 0.0))
    size = strength / reach * math.exp(-b / reach)
    if b < NONE:  # within its step: straight away (an addition; there is no gradient)
        a = max(a, LEAST)
        return size * rx / a, size * ry / a
    a, c = max(a, LEAST), max(c, LEAST)
    size *= 0.25 * (a + c) / b
    return size * (rx / a + qx / c), size * (ry / a + qy / c)


@kernel
def sight(fx: float, fy: float, ex: float, ey: float, cosine: float, behind: float) -> float:
    """Return the weight of a force f on an agent with desired direction e (Eqs. 8 and 9).

    It is 1 if the source of the force, at −f, is within the angle of sight, else ``behind``.
    """
    inside = -(fx * ex + fy * ey) >= math.sqrt(fx * fx + fy * fy) * cosine
    return 1.0 if inside else behind


@kernel
def edge_point(
    x: float, y: float, ax: float, ay: float, bx: float, by: float,
    before_x: float, before_y: float, after_x: float, after_y: float,
) -> tuple[bool, float, float]:  # fmt: skip
    """Return (counts, x, y): the edge's point nearest to (x, y); whether no other edge is nearer.

    In the paper, each border acts from its nearest point; a border here is a loop of edges,
    and it acts from every local minimum of the distance along the loop.
    """
    px, py = nearest_on_segment(x, y, ax, ay, bx, by)
    if px == ax and py == ay:
        return (x - ax) * before_x + (y - ay) * before_y >= 0.0, px, py
    if px == bx and py == by:
        return (x - bx) * after_x + (y - by) * after_y <= 0.0, px, py
    return True, px, py


@kernel
def border_force(
    x: float, y: float, excess: float, start: FloatArray, end: FloatArray, before: FloatArray,
    after: FloatArray, edges: int, strength: float, reach: float, points: FloatArray,
) -> tuple[float, float]:  # fmt: skip
    """Return the sum over borders of −∇U, U = strength · exp(−distance / reach) (Eq. 5).

    ``excess`` [m] is subtracted from the distance; ``points`` (E, 2) is scratch.
    """
    fx, fy, n = 0.0, 0.0, 0
    for k in range(edges):
        counts, px, py = edge_point(
            x, y, start[k, 0], start[k, 1], end[k, 0], end[k, 1],
            before[k, 0], before[k, 1], after[k, 0], after[k, 1],
        )  # fmt: skip
        for j in range(n):
            gx, gy = px - points[j, 0], py - points[j, 1]
            counts = counts and gx * gx + gy * gy > SAME
        if counts:
            points[n, 0], points[n, 1] = px, py
            n += 1
            dx, dy = x - px, y - py
            distance = max(math.sqrt(dx * dx + dy * dy), LEAST)
            size = strength / reach * math.exp(-(distance - excess) / reach) / distance
            fx += size * dx
            fy += size * dy
    return fx, fy
