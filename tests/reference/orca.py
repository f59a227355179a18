"""ORCA, slow and obvious: nearest boundary points by trying every piece, programs by trying
every vertex. A half-plane is (point, unit direction), permitted on its left."""

from itertools import combinations

import numpy as np


def det(a, b):
    return a[0] * b[1] - a[1] * b[0]


def turned(a, angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * a[0] - s * a[1], s * a[0] + c * a[1]])


def unit(a):
    return a / np.hypot(*a)


def neighbour(p, v, own, reach, horizon, dt, share):
    """The half-plane beside a neighbour at relative position p; v and own are velocities.

    The forbidden relative velocities are a disc about p / horizon and the cone behind
    it; u leads from v to the nearest point of their boundary.
    """
    distance = np.hypot(*p)
    if distance <= reach:
        w = v - p / dt
        u = (reach / dt - np.hypot(*w)) * unit(w)
        return own + share * u, turned(unit(w), -np.pi / 2)
    half = np.arcsin(reach / distance)
    centre = p / horizon
    pieces = []
    w = v - centre
    off_axis = abs(np.arctan2(det(-p, w), -p @ w))
    if off_axis < np.pi / 2 - half:  # the front of the disc, between the points of tangency
        pieces.append((centre + reach / horizon * unit(w), turned(unit(w), -np.pi / 2)))
    tangent = np.sqrt(distance**2 - reach**2) / horizon
    for side in (1, -1):
        leg = turned(unit(p), side * half)
        if v @ leg >= tangent:
            pieces.append((leg * (v @ leg), side * leg))
    point, direction = min(pieces, key=lambda piece: np.hypot(*(piece[0] - v)))
    return own + share * (point - v), direction


def permits(plane, v):
    """How deep v lies inside a half-plane."""
    point, direction = plane
    return det(direction, v - point)


def vertices(planes, speed):
    """Every point where two boundaries, or a boundary and the speed limit, meet."""
    points = []
    for (p, d), (q, e) in combinations(planes, 2):
        turn = det(d, e)
        if abs(turn) > 1e-12:
            points.append(p + det(e, p - q) / turn * d)
    for p, d in planes:
        root = (p @ d) ** 2 + speed**2 - p @ p
        if root >= 0:
            points += [p + (-(p @ d) + sign * np.sqrt(root)) * d for sign in (1, -1)]
    return points


def nearest(planes, speed, wanted):
    """The permitted velocity nearest to ``wanted``; None where nothing is permitted."""
    length = np.hypot(*wanted)
    points = [wanted if length <= speed else wanted / length * speed]
    points += [p + ((wanted - p) @ d) * d for p, d in planes]
    points += vertices(planes, speed)
    fitting = [
        v
        for v in points
        if np.hypot(*v) <= speed + 1e-9 and all(permits(plane, v) >= -1e-9 for plane in planes)
    ]
    return min(fitting, key=lambda v: np.hypot(*(v - wanted)), default=None)


def smallest_excess(hard, soft, speed):
    """The smallest greatest excess over ``soft`` within ``hard`` and the speed limit."""
    bisectors = []
    for (p, d), (q, e) in combinations(soft, 2):
        across = d - e
        if np.hypot(*across) < 1e-9:
            continue
        # det(d, v - p) = det(e, v - q), a line along d - e
        normal = np.array([-across[1], across[0]])
        offset = det(d, p) - det(e, q)
        bisectors.append((normal * offset / (normal @ normal), unit(across)))
    points = vertices([*hard, *bisectors], speed)
    points += [speed * turned(d, np.pi / 2) for _, d in soft]
    fitting = [
        v
        for v in points
        if np.hypot(*v) <= speed + 1e-9 and all(permits(plane, v) >= -1e-9 for plane in hard)
    ]
    return min(max(-permits(plane, v) for plane in soft) for v in fitting)


def distance_to_shadow(v, a, b, rate, radius):
    """How far v lies outside the velocities that bring a disc into the segment ab in time.

    They are the segment / t, made thicker by radius / t, for all t up to the horizon
    1 / rate: the nearest among many t, then closer and closer around it.
    """
    k = np.geomspace(rate, 1e3 * rate, 2000)
    for _ in range(4):
        p, q = k[:, None] * a, k[:, None] * b
        d = q - p
        t = np.clip(((v - p) * d).sum(1) / (d * d).sum(1), 0.0, 1.0)
        distance = np.hypot(*(v - p - t[:, None] * d).T) - k * radius
        best = int(distance.argmin())
        k = np.linspace(k[max(best - 1, 0)], k[min(best + 1, len(k) - 1)], 2000)
    return float(distance.min())
