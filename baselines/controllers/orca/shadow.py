"""The velocities that lead into an edge: a truncated capsule and the two legs behind it."""

import math

from benchnav.kernels import kernel_without_allocation

HalfPlane = tuple[float, float, float, float]


@kernel_without_allocation
def edge_shadow(
    ax: float, ay: float, bx: float, by: float, ex: float, ey: float,
    before_x: float, before_y: float, after_x: float, after_y: float,
    a_convex: bool, b_convex: bool, corner: bool,
    vx: float, vy: float, radius: float, rate: float,
) -> tuple[bool, HalfPlane]:  # fmt: skip
    """Return the half-plane at the point of the shadow's boundary that is nearest to v.

    ``corner``: a and b are one point. Legs run along the neighbouring
    edge where they would otherwise run into the solid; v beyond such a leg belongs to
    that edge, and this edge adds nothing.
    """
    left_x, left_y, left_foreign = _leg(
        ax, ay, a_convex, -ex, -ey, -before_x, -before_y, radius, 1.0
    )
    right_x, right_y, right_foreign = _leg(bx, by, b_convex, ex, ey, after_x, after_y, radius, -1.0)
    lx, ly = vx - rate * ax, vy - rate * ay  # v relative to both ends of the cut-off
    rx, ry = vx - rate * bx, vy - rate * by
    span = rate * ((bx - ax) * ex + (by - ay) * ey)
    t = lx * ex + ly * ey
    t_left = lx * left_x + ly * left_y
    t_right = rx * right_x + ry * right_y
    if (t_left < 0.0 and t_right < 0.0) if corner else (t < 0.0 and t_left < 0.0):
        return True, _arc(ax, ay, lx, ly, radius, rate)
    if not corner and t > span and t_right < 0.0:
        return True, _arc(bx, by, rx, ry, radius, rate)
    outside = corner or t < 0.0 or t > span
    to_cut = math.inf if outside else _square(lx - t * ex, ly - t * ey)
    to_left = _square(lx - t_left * left_x, ly - t_left * left_y)
    to_right = _square(rx - t_right * right_x, ry - t_right * right_y)
    to_left = math.inf if t_left < 0.0 else to_left
    to_right = math.inf if t_right < 0.0 else to_right
    if to_cut <= to_left and to_cut <= to_right:
        return True, _straight(ax, ay, -ex, -ey, radius, rate)
    if to_left <= to_right:
        return not left_foreign, _straight(ax, ay, left_x, left_y, radius, rate)
    return not right_foreign, _straight(bx, by, -right_x, -right_y, radius, rate)


@kernel_without_allocation
def _leg(
    x: float, y: float, convex: bool, ex: float, ey: float, fx: float, fy: float,
    radius: float, turn: float,
) -> tuple[float, float, bool]:  # fmt: skip
    """Return (unit direction, foreign) of the leg at a corner.

    (ex, ey) runs along the edge itself and (fx, fy) along its neighbour, both
    away from the shadow; ``turn`` is 1 for the left leg and -1 for the right one.
    """
    if not convex:
        return ex, ey, False
    distance2 = x * x + y * y
    leg = math.sqrt(max(distance2 - radius * radius, 0.0))
    r = turn * radius
    dx, dy = (x * leg - y * r) / distance2, (x * r + y * leg) / distance2
    if turn * (dx * fy - dy * fx) >= 0.0:
        return fx, fy, True
    return dx, dy, False


@kernel_without_allocation
def _arc(x: float, y: float, wx: float, wy: float, radius: float, rate: float) -> HalfPlane:
    """Return the tangent to the cut-off arc around a corner, beside w (never zero there)."""
    w = math.sqrt(wx * wx + wy * wy)
    nx, ny = wx / w, wy / w
    return rate * (x + radius * nx), rate * (y + radius * ny), ny, -nx


@kernel_without_allocation
def _straight(x: float, y: float, dx: float, dy: float, radius: float, rate: float) -> HalfPlane:
    """Return the line parallel to a leg or to the edge, one radius to the left of it."""
    return rate * (x - radius * dy), rate * (y + radius * dx), dx, dy


@kernel_without_allocation
def _square(x: float, y: float) -> float:
    return x * x + y * y
