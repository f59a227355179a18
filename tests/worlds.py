"""Small drawn worlds for tests of the simulator and the sensors."""

import math

import numpy as np

from benchnav.arena.agents import Agents
from benchnav.arena.body import Body, Law, LawKind
from benchnav.arena.sensing import EdgeSensor, NeighbourSensor, RaySensor, Sensing
from benchnav.arena.solid import Kind, Solid
from benchnav.arena.world import Afterwards, Charge, Clock, ContactRule, Rules, World

SENSING = Sensing(
    RaySensor(7, math.pi, 8.0, thick=True), NeighbourSensor(10, 10.0), EdgeSensor(16, 8.0)
)


def box(kind, x, y, half_x, half_y, angle=0.0):
    c, s = math.cos(angle), math.sin(angle)
    corners = [(-half_x, -half_y), (half_x, -half_y), (half_x, half_y), (-half_x, half_y)]
    return Solid(kind, (np.array([[x + c * u - s * v, y + s * u + c * v] for u, v in corners]),))


def walls(side):
    return Solid(Kind.WALL, (np.array([[0.0, 0.0], [0.0, side], [side, side], [side, 0.0]]),))


def disc(kind, x, y, radius):
    return Solid(kind, (), (x, y), radius)


def agents(
    start, goal, radius=0.5, speed=2.0, unicycle=False, heading=0.0, team=0, driver=0, **limits
):  # fmt: skip
    start, goal = np.atleast_2d(np.asarray(start, float)), np.atleast_2d(np.asarray(goal, float))
    n = len(start)

    def full(value, dtype=float):
        return np.broadcast_to(np.asarray(value, dtype), (n,)).copy()

    return Agents(
        start, full(heading), goal, full(radius), full(speed), full(1.0), full(2.5),
        full(unicycle, np.int8), full(0, np.int8), full(team, np.int64),
        full(driver, np.int64),
        **{name: full(value, np.asarray(value).dtype) for name, value in limits.items()},
    )  # fmt: skip


def world(
    crew, solids=(), bodies=(), side=20.0, contact=ContactRule.SLIDE, tolerance=0.3, dt=0.2,
    substeps=2, steps=250, on_arrival=Afterwards.VANISH, on_end=Afterwards.VANISH,
    charge=Charge.HITTER, sensing=SENSING, sees=None,
):  # fmt: skip
    teams = int(crew.team.max()) + 1
    sees = np.ones((teams, teams), bool) if sees is None else np.asarray(sees)
    return World(
        (0.0, 0.0, side, side), tuple(solids), tuple(bodies), crew,
        tuple(f"team {k}" for k in range(teams)), sees, Clock(dt, substeps, steps),
        Rules(tolerance, contact, on_arrival, on_end, charge), sensing,
    )  # fmt: skip


def back_and_forth(solid, a, b, speed, phase=0.0):
    a, b = np.asarray(a, float), np.asarray(b, float)
    leg = float(np.hypot(*(b - a))) / speed
    times = np.array([0.0, leg, 2 * leg])
    return Body(solid, Law(LawKind.TRACK, times, np.array([a, b, a]), True, phase))


def random_world(
    seed, count=4, contact=ContactRule.SLIDE, unicycle=True, radius=0.5, limits=None, **options
):  # fmt: skip
    """A walled square with boxes, discs and movers; agents start free of everything.

    ``unicycle`` may be any number of `Dynamics`, or one for each agent, and ``limits`` holds
    columns of `AgentBodies`.
    """
    rng = np.random.default_rng(seed)
    solids, taken = [walls(20.0)], []

    def place(radius):
        while True:
            p = rng.uniform(1.2 + radius, 18.8 - radius, 2)
            if all(np.hypot(*(p - q)) > radius + r + 0.1 for q, r in taken):
                taken.append((p, radius))
                return p

    for _ in range(4):
        half = rng.uniform(0.5, 1.0)
        p = place(1.5 * half)
        solids.append(box(Kind.STATIC, *p, half, half, rng.uniform(0, 3)))
    solids += [disc(Kind.STATIC, *place(0.7), 0.7) for _ in range(2)]
    start = np.array([place(radius) for _ in range(count)])
    movers = []
    for k in range(3):
        a = place(0.8)
        b = a + rng.uniform(-4, 4, 2)
        shape = box(Kind.DYNAMIC, 0, 0, 0.5, 0.5) if k else disc(Kind.DYNAMIC, 0, 0, 0.5)
        movers.append(back_and_forth(shape, a, b, rng.uniform(0.5, 1.5), rng.uniform(0, 5)))
    crew = agents(
        start, rng.uniform(1, 19, (count, 2)), radius, unicycle=unicycle,
        heading=rng.uniform(-3, 3, count), **(limits or {}),
    )  # fmt: skip
    return world(crew, solids, movers, contact=contact, **options)


def limited_world(seed, **options):
    """A random world of four agents: of every dynamics one, with all limits of motion."""
    none = math.inf
    limits = {
        "max_acceleration": [2.0, 1.0, 3.0, 2.0], "max_deceleration": [3.0, 3.0, none, 5.0],
        "max_turn_acceleration": [none, 6.0, 9.0, none], "track_width": [0.0, 0.0, 0.6, 0.0],
        "max_wheel_speed": [none, none, 1.8, none], "wheelbase": [0.0, 0.0, 0.0, 0.4],
        "max_steering_angle": [none, none, none, 0.7], "max_steering_rate": [none, none, none, 2.0],
        "reverse": [False, True, True, seed % 2 == 0],
    }  # fmt: skip
    return random_world(seed, 4, unicycle=[0, 1, 2, 3], limits=limits, **options)
