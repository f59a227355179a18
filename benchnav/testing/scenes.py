"""Small random worlds for the checks of navigators: walls, obstacles, a mover, agents."""

import math
from collections.abc import Collection
from dataclasses import fields, replace

import numpy as np

from benchnav.arena.agents import Agents, Dynamics, Role
from benchnav.arena.body import Body, Law, LawKind
from benchnav.arena.noise import EdgeNoise, NeighbourNoise, Noise, OdometryNoise, RayNoise
from benchnav.arena.sensing import EdgeSensor, NeighbourSensor, RaySensor, Sensing
from benchnav.arena.solid import Kind, Solid
from benchnav.arena.world import Afterwards, Charge, Clock, ContactRule, Rules, World
from benchnav.arrays import FloatArray, IntArray

SENSING = Sensing(
    RaySensor(9, math.pi, 6.0, thick=False), NeighbourSensor(4, 6.0), EdgeSensor(8, 6.0)
)
USUAL = Sensing(
    RaySensor(7, math.pi, 8.0, thick=True), NeighbourSensor(10, 10.0), EdgeSensor(16, 8.0)
)  # the defaults of scenarios
CLOCK = Clock(dt=0.25, substeps=2, steps=200, decision_budget=1.0)
RULES = Rules(0.3, ContactRule.SLIDE, Afterwards.VANISH, Afterwards.VANISH, Charge.HITTER)
NOISE = Noise(
    RayNoise(0.05, 0.05, dropout=0.2, approach_noise=0.3),
    NeighbourNoise(0.2, 0.3, missed=0.3, false_alarms=0.5, field_of_view=4.0),
    EdgeNoise(0.05, missed=0.2, field_of_view=4.0),
    OdometryNoise(0.1, 0.1, 0.1, correction_period=1.0, correction_position_noise=0.2),
    delay=1,
)  # larger than that of scenarios, so that a few decisions show every error
_CELL, _CELLS = 2.4, 5  # [m] size and number per side; objects do not reach the next cell


def scene(seed: int, agents: int) -> World:
    """Return a walled square of 12 m with two boxes, a disc, a mover and up to 8 ``agents``.

    Agents differ in radius, speed, role and dynamics; nothing overlaps at the start.
    """
    rng = np.random.default_rng([seed, agents])
    cells = rng.permutation(_CELLS * _CELLS)[: 4 + 2 * agents]
    corner = np.stack([cells // _CELLS, cells % _CELLS], axis=1) * _CELL
    places = corner + 0.5 * _CELL + rng.uniform(-0.3, 0.3, corner.shape)
    square = 0.5 * np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    side = _CELL * _CELLS
    solids = (
        Solid(Kind.WALL, (side * (square[::-1] + 0.5),)),
        *(Solid(Kind.STATIC, (square + place,)) for place in places[:2]),
        Solid(Kind.STATIC, center=(float(places[2, 0]), float(places[2, 1])), radius=0.5),
    )
    track = np.stack([places[3], places[3] + rng.uniform(-1.0, 1.0, 2), places[3]])
    law = Law(LawKind.TRACK, np.array([0.0, 2.0, 4.0]), track, periodic=True)
    return World(
        (0.0, 0.0, side, side), solids, (Body(Solid(Kind.DYNAMIC, radius=0.3), law),),
        _agents(rng, places[4 : 4 + agents], places[4 + agents :]), ("all",),
        np.ones((1, 1), np.bool_), CLOCK, RULES, SENSING,
    )  # fmt: skip


def _agents(rng: np.random.Generator, start: FloatArray, goal: FloatArray) -> Agents:
    count = len(start)
    speed = rng.uniform(0.8, 1.6, count)
    return Agents(
        start, rng.uniform(-math.pi, math.pi, count), goal, rng.uniform(0.2, 0.4, count),
        1.5 * speed, speed, rng.uniform(1.0, 3.0, count),
        rng.choice([int(Dynamics.HOLONOMIC), int(Dynamics.UNICYCLE)], count).astype(np.int8),
        rng.choice([int(role) for role in Role], count).astype(np.int8),
        np.zeros(count, np.int64), np.zeros(count, np.int64),
    )  # fmt: skip


def with_bodies(world: World, drives: Collection[str]) -> World:
    """Return the world with bodies of these dynamics in turn, and with limits of acceleration.

    Every second body, from the first on, is a capsule.
    """
    names = [kind for kind in Dynamics if kind.name.lower().replace("_", "-") in drives]
    kinds = np.resize(np.array(names, np.int8), len(world.agents))
    is_capsule, radius = np.arange(len(kinds)) % 2 == 0, world.agents.radius
    wheels, car = kinds == Dynamics.DIFFERENTIAL_DRIVE, kinds == Dynamics.ACKERMANN
    limits = {
        "max_acceleration": np.full(len(kinds), 1.0),
        "max_deceleration": np.full(len(kinds), 2.0),
        "max_turn_acceleration": np.where(car, np.inf, 4.0),
        "track_width": np.where(wheels, 0.3, 0.0),
        "max_wheel_speed": np.where(wheels, 1.0, np.inf),
        "wheelbase": np.where(car, 0.3, 0.0),
        "max_steering_angle": np.where(car, 0.6, np.inf),
        "max_steering_rate": np.where(car, 2.0, np.inf),
        "reverse": (kinds != Dynamics.HOLONOMIC) & ~is_capsule,
        "half_length": np.where(is_capsule, radius, 0.0),
        "half_width": np.where(is_capsule, 0.6 * radius, 0.0),
        "rounding": np.where(is_capsule, 0.6 * radius, 0.0),
    }
    return replace(world, agents=replace(world.agents, dynamics=kinds, **limits))


def renumbered(world: World, order: IntArray) -> World:
    """Return the same world with agent ``order[k]`` at index k."""
    agents = {f.name: getattr(world.agents, f.name)[order] for f in fields(world.agents)}
    return replace(world, agents=Agents(**agents))
