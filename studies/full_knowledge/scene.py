"""The knowledge of the search about a world, as arrays for kernels."""

from typing import NamedTuple

import numpy as np

from benchnav.arena.agents import Dynamics
from benchnav.arena.world import Afterwards, ContactRule, World
from benchnav.arrays import FloatArray, IntArray
from benchnav.errors import UsageError
from benchnav.geometry.capsule_grid import CapsuleGrid, capsule_grid
from benchnav.world.bodies import body_at, stack_bodies

MARGIN = 1e-6  # [m] that plans keep from everything, so that rounding decides nothing


class Task(NamedTuple):
    """One agent, and the clock."""

    x: float  # [m]
    y: float
    heading: float  # [rad]
    goal_x: float  # [m]
    goal_y: float
    tolerance: float  # [m] between centre and goal
    radius: float  # [m]
    max_speed: float  # [m/s]
    max_turn_rate: float  # [rad/s]
    h: float  # [s] of a substep
    substeps: int  # in a decision
    steps: int  # decisions until the horizon


class Movers(NamedTuple):
    """The M dynamic obstacles at every one of K + 1 ticks (ends of substeps)."""

    place: FloatArray  # (K+1, M, 2) [m]
    bound: FloatArray  # (M,) [m] radius of the circle around a body's origin that holds it
    capsules: FloatArray  # (P, 5) in the frames of the bodies
    first: IntArray  # (M+1,) capsules of each body


class Traffic(NamedTuple):
    """Where the N agents that were planned before are at every tick."""

    place: FloatArray  # (N, K+1, 2) [m]
    ticks: IntArray  # (N,) substeps after which each is gone
    radius: FloatArray  # (N,) [m]


class Scene(NamedTuple):
    """Everything that is the same for all agents of a world; ``ground`` is by agent radius."""

    tasks: tuple[Task, ...]
    ground: dict[float, CapsuleGrid]
    movers: Movers
    bounds: tuple[float, float, float, float]  # xmin, ymin, xmax, ymax [m]


def scene(world: World) -> Scene:
    """The scene of ``world``.

    Raises:
        UsageError: the world is of a kind that the planner does not know.
    """
    check(world)
    solids = [solid.capsules for solid in world.solids]
    capsules = np.concatenate([np.zeros((0, 5)), *solids])
    radii = {float(radius) for radius in world.agents.radius}
    return Scene(
        tuple(task(world, i) for i in range(len(world.agents))),
        {radius: capsule_grid(capsules, radius + MARGIN) for radius in radii},
        movers(world),
        world.bounds,
    )


def check(world: World) -> None:
    """Raise where plans would not hold: the arena of the leaders is assumed."""
    rules, agents = world.rules, world.agents
    wanted = {
        "unicycles only": bool((agents.dynamics == int(Dynamics.UNICYCLE)).all()),
        "evaluated agents only": bool(agents.evaluated.all()),
        "no static obstacle that moves meanwhile": not world.relocates,
        "contacts that end": rules.contact == ContactRule.END,
        "agents that vanish": rules.on_arrival == rules.on_end == Afterwards.VANISH,
    }
    missing = [what for what, holds in wanted.items() if not holds]
    if missing:
        raise UsageError(f"The planner with full knowledge needs {', '.join(missing)}.")


def task(world: World, i: int) -> Task:
    """The task of agent i."""
    agents, clock = world.agents, world.clock
    return Task(
        float(agents.start[i, 0]), float(agents.start[i, 1]), float(agents.heading[i]),
        float(agents.goal[i, 0]), float(agents.goal[i, 1]), float(world.rules.goal_tolerance),
        float(agents.radius[i]), float(agents.max_speed[i]), float(agents.max_turn_rate[i]),
        clock.dt / clock.substeps, clock.substeps, clock.steps,
    )  # fmt: skip


def movers(world: World) -> Movers:
    """The bodies of ``world`` at every tick, as the simulator places them."""
    records, _, knots = stack_bodies([world])
    h, ticks = world.clock.dt / world.clock.substeps, world.clock.steps * world.clock.substeps
    place = np.zeros((ticks + 1, len(world.bodies), 2))
    for m in range(len(world.bodies)):
        place[:, m] = [body_at(records[0, m], knots, tick * h) for tick in range(ticks + 1)]
    shapes = [body.solid.capsules for body in world.bodies]
    first = np.cumsum([0, *map(len, shapes)])
    bound = np.array([body.solid.bounding_radius for body in world.bodies])
    return Movers(place, bound, np.concatenate([np.zeros((0, 5)), *shapes]), first)
