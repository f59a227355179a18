"""ORCA crowds: sensing + ORCA + step of benchnav against its peers, side by side.

Agents on a circle exchange places; 0.63 m lie between neighbours on it. Each avoids the nearest
ten others within 10 m; the time step is 0.25 s. In a gridlock, agents stand in a square, go to its
middle and keep no margin, so that nearly all of them are in contact all the time. The timed part,
after a warm-up:

- benchnav: observation (sensing), decision (`orca`) and simulator step, with contacts and all work
  of the runner between them;
- pyrvo: only `do_step`, without the Python loop that sets preferred velocities;
- navground: the update of a world of ORCA agents;
- jupedsim: 25 iterations of 0.01 s of its social force model on the same circle, because these
  forces are not stable at longer steps;
- camar: 25 steps of 0.01 s of a compiled environment (JAX on the processor), with contact forces
  and observations, but without decisions, of agents in a square without obstacles. Its area for an
  agent is that of its default map.

So a step is 0.25 s of simulated time for all of them. Every measurement runs in a separate
interpreter, benchnav in this one's environment and the peers in theirs.
"""

import json
import math
import os
import subprocess
import sys
from dataclasses import astuple, dataclass
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import Any

from benchmarks.pair import NotMeasuredError, Pair

ROOT = Path(__file__).resolve().parents[1]
GAP, RADIUS = 0.2 * math.pi, 0.2  # [m]
NEIGHBOURS, RANGE, HORIZON = 10, 10.0, 5.0  # [m], [s]
SPEED, LIMIT, DT = 1.0, 1.5, 0.25  # [m/s], [m/s], [s]
PACKED = 0.401  # [m] between agents in a gridlock
SHORT = 0.01  # [s] step of peers with forces

Places = list[tuple[float, float]]


@dataclass(frozen=True)
class Crowd:
    """A crowd to measure, and the threads that benchnav may use."""

    agents: int = 1000
    threads: int = 1
    gridlock: bool = False

    def __str__(self) -> str:
        kind = "gridlock" if self.gridlock else "ORCA crowd"
        return f"{kind} of {self.agents:,}, {self.threads} thread{'s' * (self.threads > 1)}"

    @property
    def steps(self) -> int:
        """The number of timed steps."""
        return 20 if self.gridlock else max(10, min(100, 1_000_000 // self.agents))

    @property
    def warm(self) -> int:
        """The number of steps before them."""
        return self.steps // 5

    @property
    def starts(self) -> Places:
        """The starts of the agents; the goals lie opposite."""
        n = self.agents
        if self.gridlock:
            side = math.ceil(math.sqrt(n))
            middle = 0.5 * (side - 1)
            return [(PACKED * (k % side - middle), PACKED * (k // side - middle)) for k in range(n)]
        circle = GAP * n / (2.0 * math.pi)
        angles = [2.0 * math.pi * k / n for k in range(n)]
        return [(circle * math.cos(a), circle * math.sin(a)) for a in angles]


LARGE, JAM = Crowd(100_000), Crowd(gridlock=True)
# (ours, a peer on the same crowd or another crowd of ours, the ratio of rates to reach)
WANTED: tuple[tuple[Crowd, str | Crowd, float], ...] = (
    (Crowd(100), "pyrvo", 3.0), (Crowd(), "pyrvo", 4.5), (Crowd(10_000), "pyrvo", 4.0),
    (LARGE, "pyrvo", 3.5), (Crowd(100, 2), "pyrvo", 3.0), (Crowd(1000, 2), "pyrvo", 7.5),
    (Crowd(10_000, 2), "pyrvo", 6.4), (Crowd(100_000, 2), "pyrvo", 5.6),
    (Crowd(), "navground", 20.0), (Crowd(), "jupedsim", 1.0), (Crowd(100), "camar", 1.0),
    (Crowd(1000, 2), Crowd(), 1.6), (Crowd(10_000, 2), Crowd(10_000), 1.6),
    (Crowd(100_000, 2), LARGE, 1.6), (LARGE, Crowd(), 1.0 / 1.3), (JAM, Crowd(), 0.5),
)  # fmt: skip

STEP = (
    "The search for neighbours takes 0.4 of a step of 1,000 agents, ORCA 0.3, contacts and motion"
    " 0.1, sorting and Python between the kernels 0.2."
)
MANY = "The observation, 410 bytes an agent, is allocated anew at each step."
THREADS = "Contacts, motion, sorting and Python use one thread, and hand-offs take time."
TOUCHES = "Each of 3,500 touches a step changes the next touches of some 34 agents."


def limit(crowd: Crowd) -> str:
    """Return what limits the rate of a crowd."""
    if crowd.gridlock:
        return TOUCHES
    if crowd.threads > 1:
        return THREADS
    return MANY if crowd.agents > 1000 else STEP


def benchnav(crowd: Crowd) -> float:
    """Return the time of the steps [s]."""
    import numpy as np

    from benchnav.navigation.plugin.configure import make
    from benchnav.plugins import NAVIGATORS
    from benchnav.runner.rollouts.navigator_driver import Driver
    from benchnav.world.simulation import Simulation

    simulation = Simulation([crowd_world(crowd)])
    navigator = {"type": "orca", "margin": 0.0} if crowd.gridlock else "orca"
    driver = Driver(make(NAVIGATORS, navigator), simulation, 0, "unknown")
    driver.reset([np.random.default_rng(0)])
    command, twist = np.zeros((1, crowd.agents, 2)), np.zeros((1, crowd.agents), np.bool_)
    began = 0.0
    for step in range(crowd.warm + crowd.steps):
        if step == crowd.warm:
            began = perf_counter()
        driver.act(command, step * DT)
        simulation.step(command, twist)
    return perf_counter() - began


def crowd_world(crowd: Crowd) -> Any:
    """Return the crowd as a world without walls."""
    import numpy as np

    from benchnav.arena.agents import Agents
    from benchnav.arena.sensing import NeighbourSensor, Sensing
    from benchnav.arena.world import Afterwards, Charge, Clock, ContactRule, Rules, World

    start = np.array(crowd.starts)
    same, none = np.ones(crowd.agents), np.zeros(crowd.agents, np.int64)
    agents = Agents(
        start, np.zeros(crowd.agents), -start, RADIUS * same, LIMIT * same, SPEED * same, same,
        none.astype(np.int8), none.astype(np.int8), none, none,
    )  # fmt: skip
    rules = Rules(0.1, ContactRule.SLIDE, Afterwards.STAY, Afterwards.STAY, Charge.BOTH)
    sensing = Sensing(None, NeighbourSensor(NEIGHBOURS, RANGE), None)
    reach = 1.2 * float(np.abs(start).max())
    return World(
        (-reach, -reach, reach, reach), (), (), agents, ("crowd",), np.ones((1, 1), np.bool_),
        Clock(DT, 1, 10 * (crowd.warm + crowd.steps)), rules, sensing,
    )  # fmt: skip


def pyrvo(crowd: Crowd) -> float:
    """Return the time of the steps [s]."""
    from pyrvo import RVOSimulator

    simulator, start = RVOSimulator(), crowd.starts
    simulator.set_time_step(DT)
    simulator.set_agent_defaults(RANGE, NEIGHBOURS, HORIZON, HORIZON, RADIUS, LIMIT)
    for place in start:
        simulator.add_agent(place)
    seconds = 0.0
    for step in range(crowd.warm + crowd.steps):
        for k, (sx, sy) in enumerate(start):
            x, y = simulator.get_agent_position(k).to_tuple()
            dx, dy = -sx - x, -sy - y
            scale = SPEED / max(math.hypot(dx, dy), SPEED)
            simulator.set_agent_pref_velocity(k, (scale * dx, scale * dy))
        began = perf_counter()
        simulator.do_step()
        if step >= crowd.warm:
            seconds += perf_counter() - began
    return seconds


def navground(crowd: Crowd) -> float:
    """Return the time of the steps [s]."""
    from navground import core, sim

    world = sim.World()
    for k, (x, y) in enumerate(crowd.starts):
        behavior = core.Behavior.make_type("ORCA")
        behavior.max_number_of_neighbors, behavior.time_horizon = NEIGHBOURS, HORIZON
        behavior.horizon, behavior.optimal_speed = RANGE, SPEED
        state = sim.StateEstimation.make_type("Bounded")
        state.range = RANGE
        task = sim.Task.make_type("Waypoints")
        task.waypoints, task.loop = [(-x, -y)], False
        kinematics = core.Kinematics.make_type("Omni")
        kinematics.max_speed = LIMIT
        agent = sim.Agent(
            radius=RADIUS, behavior=behavior, kinematics=kinematics, task=task,
            state_estimations=[state], id=k,
        )  # fmt: skip
        agent.position = (x, y)
        world.add_agent(agent)
    began = 0.0
    for step in range(crowd.warm + crowd.steps):
        if step == crowd.warm:
            began = perf_counter()
        world.update(DT)
    return perf_counter() - began


def jupedsim(crowd: Crowd) -> float:
    """Return the time of the steps [s]."""
    import jupedsim as jps
    import shapely

    reach = 1.2 * max(x for x, _ in crowd.starts)
    area = shapely.box(-reach, -reach, reach, reach)
    simulation = jps.Simulation(model=jps.SocialForceModel(), geometry=area, dt=SHORT)
    for x, y in crowd.starts:
        stage = simulation.add_waypoint_stage((-x, -y), 0.1)
        journey = simulation.add_journey(jps.JourneyDescription([stage]))
        simulation.add_agent(
            jps.SocialForceModelAgentParameters(
                position=(x, y), journey_id=journey, stage_id=stage, desired_speed=SPEED,
                radius=RADIUS,
            )
        )  # fmt: skip
    each = round(DT / SHORT)
    simulation.iterate(crowd.warm * each)
    began = perf_counter()
    simulation.iterate(crowd.steps * each)
    return perf_counter() - began


def camar(crowd: Crowd) -> float:
    """Return the time of the steps [s]."""
    import jax
    from camar.environment import Camar
    from camar.maps import random_grid

    jax.config.update("jax_platforms", "cpu")
    side = math.ceil(math.sqrt(12.5 * crowd.agents))  # 400 cells for 32 agents by default
    place = random_grid(num_rows=side, num_cols=side, obstacle_density=0.0, num_agents=crowd.agents)
    environment = Camar(place, frameskip=round(DT / SHORT) - 1)
    key = jax.random.key(0)
    _, state = jax.jit(environment.reset)(key)
    action = jax.random.uniform(key, (crowd.agents, 2), minval=-1.0, maxval=1.0)
    step = jax.jit(environment.step)
    began = 0.0
    for k in range(crowd.warm + crowd.steps):
        if k == crowd.warm:
            jax.block_until_ready(state)
            began = perf_counter()
        _, state, *_ = step(key, state, action)
    jax.block_until_ready(state)
    return perf_counter() - began


PARTS = {
    "benchnav": benchnav, "pyrvo": pyrvo, "navground": navground, "jupedsim": jupedsim,
    "camar": camar,
}  # fmt: skip


def answer(part: str, crowd: Crowd) -> dict[str, Any]:
    """Return the output of a subprocess: agent-steps a second, or why there are none."""
    try:
        return {"rate": crowd.agents * crowd.steps / PARTS[part](crowd)}
    except ImportError as error:
        return {"skipped": f"{part} is not installed ({error})"}


def rate(python: str, part: str, crowd: Crowd) -> float:
    """Return agent-steps a second of one part, measured in a separate interpreter.

    It runs as a module: the folder of a script would be first on the path, and one of our files
    may have the name of a package that a library imports.

    Raises NotMeasuredError if the part is not installed or fails.
    """
    command = [python, "-m", "benchmarks.orca_peers", part, json.dumps(astuple(crowd))]
    threads = {"BENCHNAV_THREADS": str(crowd.threads)}
    done = subprocess.run(
        command, capture_output=True, text=True, check=False, cwd=ROOT, env=os.environ | threads
    )
    if done.returncode != 0 or not done.stdout:
        last = done.stderr.strip().splitlines()[-1:] or ["no output"]
        raise NotMeasuredError(f"{part} failed: {last[0]}")
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    if "skipped" in found:
        raise NotMeasuredError(found["skipped"])
    return float(found["rate"])


def pairs(peers: str) -> list[Pair]:
    """Return the pair of each entry of `WANTED`; ``peers`` is an interpreter that has the peers."""
    return [
        Pair(
            name=f"{crowd} against {other}", unit="agent-steps/s", wanted=wanted, peer=f"{other}",
            limit=limit(crowd),
            ours=partial(rate, sys.executable, "benchnav", crowd), warm=False, blocks=2,
            theirs=partial(rate, sys.executable, "benchnav", other) if isinstance(other, Crowd)
            else partial(rate, peers, other, crowd),
        )
        for crowd, other, wanted in WANTED
    ]  # fmt: skip


if __name__ == "__main__":
    print(json.dumps(answer(sys.argv[1], Crowd(*json.loads(sys.argv[2])))))
