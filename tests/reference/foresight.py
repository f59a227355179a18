"""The slow, obvious twin of `benchnav_baselines.learned.recurrent_ppo.foresight`."""

import math

import numpy as np
from benchnav_baselines.learned.recurrent_ppo import foresight as f
from shapely import LineString, Point

from benchnav.arena.solid import Kind


def danger(twist, seen, bodies, tolerance, b, a, hold):
    """Of one twist of agent (b, a), held as long as is safest."""
    times = np.arange(f.HELD, hold + 1e-9, f.HELD)
    return min(danger_held(twist, seen, bodies, tolerance, b, a, held) for held in times)


def danger_held(twist, seen, bodies, tolerance, b, a, held):
    """0 where it touches nothing before horizon or goal."""
    near, edges = seen.neighbours, seen.edges
    radius = bodies.radius[b, a]
    walls = [
        LineString([edges.start[b, a, e], edges.end[b, a, e]]) for e in range(edges.count[b, a])
    ]
    back = 0.0
    for k, spot in enumerate(places(twist, seen, b, a, held)):
        time = (k + 1) * f.TICK
        for n in range(near.count[b, a]):
            if time > f.AGENT_HORIZON + 1e-9 and near.kind[b, a, n] == Kind.AGENT:
                continue
            mover = near.kind[b, a, n] == Kind.DYNAMIC
            reach = radius + near.radius[b, a, n] + f.MARGIN * (2 if mover else 1)
            travelled = time * near.velocity[b, a, n]
            turned = math.dist(near.position[b, a, n] - travelled, spot) < reach
            if mover and time <= f.FIXED and back == 0.0 and turned:
                back = f.BACK * (1 - k * f.TICK / f.FIXED)
            if math.dist(near.position[b, a, n] + travelled, spot) < reach:
                return f.HIT + f.SOONER * (1 - k * f.TICK / f.HORIZON) + back
        touched = any(wall.distance(Point(spot)) < radius + f.MARGIN for wall in walls)
        if time <= f.FIXED and touched:
            return f.HIT + f.SOONER * (1 - k * f.TICK / f.FIXED) + back
        if math.dist(spot, seen.goal[b, a]) < tolerance[b, a]:
            return back
    return back


def places(twist, seen, b, a, held):
    """The place at each tick until the horizon: the course is kept after the twist."""
    v, w = twist
    spot, heading = seen.position[b, a], seen.heading[b, a]
    for k in range(round(f.HORIZON / f.TICK)):
        turn = w if (k + 1) * f.TICK <= held + 1e-9 else 0.0
        way = heading + turn * f.TICK / 2
        spot = spot + v * f.TICK * np.array([math.cos(way), math.sin(way)])
        heading += turn * f.TICK
        yield spot


def corrected(twist, seen, bodies, tolerance, b, a, hold=f.HELD):
    """The twist that is best by danger and likeness; the learned one where both are zero."""
    top, rate = bodies.max_speed[b, a], bodies.max_turn_rate[b, a]
    choices = [tuple(twist)]
    if danger(twist, seen, bodies, tolerance, b, a, hold) > 0:
        choices += [
            (v, w) for v in np.linspace(0, top, f.SPEEDS) for w in np.linspace(-rate, rate, f.TURNS)
        ]

    def cost(choice):
        apart = abs(choice[0] - twist[0]) / top + abs(choice[1] - twist[1]) / rate / 2
        return danger(choice, seen, bodies, tolerance, b, a, hold) + apart

    return min(choices, key=cost)
