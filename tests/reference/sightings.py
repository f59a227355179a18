"""The slow, obvious twin of `benchnav_baselines.learned.recurrent_ppo.sightings`."""

import math

import numpy as np
from benchnav_baselines.learned.recurrent_ppo import sightings as s
from shapely import LineString, Point

from benchnav.arena.solid import Kind


def ends(seen, b, a):
    """(kind, place) where the disc of each ray came to rest."""
    course = seen.heading[b, a] + seen.rays.angle
    way = np.stack([np.cos(course), np.sin(course)], axis=-1) * seen.rays.distance[b, a, :, None]
    return list(zip(seen.rays.kind[b, a], seen.position[b, a] + way, strict=True))


def others(seen, radius, dt, before, b, a):
    """[(kind, position, velocity, radius, age)]: who is met now, then who was (``before``)."""
    near, met = seen.neighbours, []
    for n in range(near.count[b, a]):
        reach = radius + near.radius[b, a, n] + s.SLACK
        if any(
            kind == near.kind[b, a, n] and math.dist(place, near.position[b, a, n]) <= reach
            for kind, place in ends(seen, b, a)
        ):
            met.append(
                (near.kind[b, a, n], near.position[b, a, n], near.velocity[b, a, n],
                 near.radius[b, a, n], 0.0)
            )  # fmt: skip
    kept = [(k, p + dt * v, v, r, age + dt) for k, p, v, r, age in before]
    kept = [one for one in kept if one[4] <= s.MEMORY + 1e-9]
    lost = [o for o in kept if all(o[0] != m[0] or math.dist(o[1], m[1]) > s.SAME for m in met)]
    return (met + lost)[: s.MAX_OTHERS]


def seen_others(seen, dt, before, b, a):
    """As `others`, of an agent without rays: all in sight are met, and only movers remembered."""
    near = seen.neighbours
    met = [
        (near.kind[b, a, n], near.position[b, a, n], near.velocity[b, a, n],
         near.radius[b, a, n], 0.0)
        for n in range(near.count[b, a])
    ]  # fmt: skip
    kept = [(k, p + dt * v, v, r, age + dt) for k, p, v, r, age in before if k == Kind.DYNAMIC]
    kept = [one for one in kept if one[4] <= s.MEMORY + 1e-9]
    lost = [o for o in kept if all(o[0] != m[0] or math.dist(o[1], m[1]) > s.SAME for m in met)]
    return (met + lost)[: s.MAX_OTHERS]


def edges(seen, radius, b, a):
    """[(start, end)] on which a ray came to rest."""
    fixed = [Point(place) for kind, place in ends(seen, b, a) if kind in (Kind.WALL, Kind.STATIC)]
    every = range(seen.edges.count[b, a])
    found = [(seen.edges.start[b, a, e], seen.edges.end[b, a, e]) for e in every]
    return [e for e in found if any(LineString(e).distance(p) <= radius + s.SLACK for p in fixed)]
