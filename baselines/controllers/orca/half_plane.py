"""Half-planes of permitted velocities: one for each neighbour, one for each edge of a solid.

A half-plane is (x, y, dx, dy): a point on its boundary [m/s] and the unit
direction of the boundary; velocities to the left of it are permitted. Positions
are relative to the agent. Formulas: van den Berg, Guy, Lin and Manocha 2011,
"Reciprocal n-body collision avoidance", sections 4 (agents) and 5.4 (obstacles).
"""

import math

from benchnav.kernels import kernel_without_allocation

from .shadow import edge_shadow

COVERED = 1e-5  # [m/s] an edge that exceeds an earlier half-plane by less adds nothing

HalfPlane = tuple[float, float, float, float]


@kernel_without_allocation
def neighbour_half_plane(
    px: float, py: float, vx: float, vy: float, ux: float, uy: float,
    reach: float, rate: float, step_rate: float, share: float,
) -> HalfPlane:  # fmt: skip
    """Return the half-plane of an agent's permitted velocities beside a neighbour.

    (px, py) is the neighbour's position relative to the agent [m], (vx, vy) the
    agent's velocity relative to the neighbour and (ux, uy) its own [m/s]; reach
    is the sum of the radii [m], rate 1 / time horizon [1/s], step_rate 1 / decision
    step [1/s] (the horizon once discs overlap), and share the part of the change that
    the agent makes: 0.5 beside an agent that does the same, 1 beside a mover.
    """
    distance2 = px * px + py * py
    apart = distance2 > reach * reach
    if not apart:
        rate = step_rate
    wx, wy = vx - rate * px, vy - rate * py  # from the centre of the cut-off disc
    w2 = wx * wx + wy * wy
    inward = wx * px + wy * py
    if not apart or (inward < 0.0 and inward * inward > reach * reach * w2):
        w = math.sqrt(w2)
        nx, ny = _normal(wx, wy, w, px, py, distance2)
        push = share * (reach * rate - w)
        return ux + push * nx, uy + push * ny, ny, -nx
    leg = math.sqrt(distance2 - reach * reach)
    leg = leg if px * wy - py * wx > 0.0 else -leg  # left or right
    inverse = 1.0 / distance2
    dx, dy = (px * leg - py * reach) * inverse, (px * reach + py * leg) * inverse
    along = vx * dx + vy * dy
    return ux + share * (along * dx - vx), uy + share * (along * dy - vy), dx, dy


@kernel_without_allocation
def _normal(
    wx: float, wy: float, w: float, px: float, py: float, distance2: float
) -> tuple[float, float]:
    """Return w / |w|; an addition: straight away if w is zero, and +x if that is zero too."""
    if w > 0.0:
        return wx / w, wy / w
    if distance2 > 0.0:
        distance = math.sqrt(distance2)
        return -px / distance, -py / distance
    return 1.0, 0.0


@kernel_without_allocation
def edge_half_plane(
    ax: float, ay: float, bx: float, by: float,
    before_x: float, before_y: float, after_x: float, after_y: float,
    a_convex: bool, b_convex: bool,
    vx: float, vy: float, radius: float, rate: float,
) -> tuple[bool, HalfPlane]:  # fmt: skip
    """Return (True, half-plane) of an edge from a to b, or (False, …) if it permits all.

    a and b are relative to the agent [m], the solid is on the left of ab, and
    is convex in a and in b or not; before and after are the unit directions of
    the edges that end in a and begin in b; v is the agent's velocity [m/s],
    radius its radius [m], rate 1 / time horizon for obstacles [1/s].
    """
    ex, ey = bx - ax, by - ay
    length2 = ex * ex + ey * ey
    if not length2 > 0.0:
        return False, (0.0, 0.0, 1.0, 0.0)
    length = math.sqrt(length2)
    ex, ey = ex / length, ey / length
    along = -(ax * ex + ay * ey) / length  # 0 beside a, 1 beside b
    across = ax * ey - ay * ex
    radius2 = radius * radius
    if along < 0.0 and ax * ax + ay * ay <= radius2:
        return a_convex, _corner(ax, ay)
    if along > 1.0 and bx * bx + by * by <= radius2:
        # if b's other edge faces the agent too, that edge covers b
        return b_convex and bx * after_y - by * after_x >= 0.0, _corner(bx, by)
    if across * across > radius2:
        side = 0
    elif along < 0.0:
        side = -1
    elif along > 1.0:
        side = 1
    else:
        return True, (0.0, 0.0, -ex, -ey)
    if side < 0:  # at such an oblique angle only a matters
        bx, by, b_convex, after_x, after_y = ax, ay, a_convex, ex, ey
    elif side > 0:
        ax, ay, a_convex, before_x, before_y = bx, by, b_convex, ex, ey
    if side != 0 and not a_convex:
        return False, (0.0, 0.0, 1.0, 0.0)
    return edge_shadow(
        ax, ay, bx, by, ex, ey, before_x, before_y, after_x, after_y,
        a_convex, b_convex, side != 0, vx, vy, radius, rate,
    )  # fmt: skip


@kernel_without_allocation
def _corner(x: float, y: float) -> HalfPlane:
    """Return the half-plane that forbids to approach a touched corner."""
    length = math.sqrt(x * x + y * y)
    if length == 0.0:  # on the corner itself all directions are equally good
        return 0.0, 0.0, 1.0, 0.0
    return 0.0, 0.0, -y / length, x / length


@kernel_without_allocation
def covers(
    half_plane: HalfPlane, ax: float, ay: float, bx: float, by: float, radius: float, rate: float
) -> bool:
    """Whether the half-plane already forbids all velocities that the edge from a to b would."""
    x, y, dx, dy = half_plane
    margin = rate * radius - COVERED
    return (rate * ax - x) * dy - (rate * ay - y) * dx >= margin and (
        (rate * bx - x) * dy - (rate * by - y) * dx >= margin
    )
