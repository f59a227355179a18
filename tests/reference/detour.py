"""The slow, obvious twin of `benchnav_baselines.learned.recurrent_ppo.detour`."""

import math

import numpy as np
from benchnav_baselines.learned.recurrent_ppo import detour as d
from shapely import LineString, Point


def room(seen, radius, course, b, a):
    """[m] of a straight way on which nothing is touched, in whole strides."""
    near, edges = seen.neighbours, seen.edges
    walls = [
        LineString([edges.start[b, a, e], edges.end[b, a, e]]) for e in range(edges.count[b, a])
    ]
    for step in range(1, round(d.ROOM / d.STRIDE) + 1):
        spot = seen.position[b, a] + step * d.STRIDE * np.array(
            [math.cos(course), math.sin(course)]
        )
        hit = any(
            math.dist(spot, near.position[b, a, n]) < radius + near.radius[b, a, n] + 2 * d.MARGIN
            for n in range(near.count[b, a])
        )
        if hit or any(wall.distance(Point(spot)) < radius + d.MARGIN for wall in walls):
            return (step - 1) * d.STRIDE
    return d.ROOM


def course(seen, radius, b, a, last=None):
    """[rad] of the way that is taken."""
    way = seen.goal[b, a] - seen.position[b, a]
    ahead = math.atan2(way[1], way[0])
    choices = [ahead + 2 * math.pi * k / d.COURSES for k in range(d.COURSES)]

    def value(choice):
        tired = 0.0 if last is None else d.AGAIN * max(0.0, math.cos(choice - last))
        return math.cos(choice - ahead) - tired + room(seen, radius, choice, b, a)

    return max(choices, key=value)
