"""ORCA crowd: sensing + ORCA + step of benchnav against the ORCA of its peers, side by side.

A thousand agents on a circle of 100 m exchange places. Each avoids the nearest ten
others within 10 m; the time step is 0.25 s. The timed part, after the same warm-up of 20 steps:

- benchnav: observation (sensing), decision (`orca` with its defaults) and simulator step,
  with contacts and all work of the runner between them;
- pyrvo: only `do_step`, without the Python loop that sets preferred velocities;
- navground: the update of a world of ORCA agents.

Every measurement runs in a separate interpreter; the parts run in turns, and the
best of three rounds counts. ``python -m benchmarks.orca_peers PEERS_PYTHON`` prints
the rows; PEERS_PYTHON is an interpreter that has pyrvo and navground.
"""

import json
import math
import subprocess
import sys
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from time import perf_counter
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
AGENTS, CIRCLE, RADIUS = 1000, 100.0, 0.2  # [m]
NEIGHBOURS, RANGE, HORIZON = 10, 10.0, 5.0  # [m], [s]
SPEED, LIMIT, DT = 1.0, 1.5, 0.25  # [m/s], [m/s], [s]
WARM, STEPS, ROUNDS = 20, 100, 3

Places = list[tuple[float, float]]


def places() -> Places:
    """Return the starts of the agents; their goals are opposite."""
    angles = [2.0 * math.pi * k / AGENTS for k in range(AGENTS)]
    return [(CIRCLE * math.cos(a), CIRCLE * math.sin(a)) for a in angles]


def benchnav() -> float:
    """Return the time of STEPS steps [s]."""
    import numpy as np

    from benchnav.navigation.plugin.configure import make
    from benchnav.plugins import NAVIGATORS
    from benchnav.runner.rollouts.navigator_driver import Driver
    from benchnav.world.simulation import Simulation

    simulation = Simulation([crowd_world()])
    driver = Driver(make(NAVIGATORS, "orca"), simulation, 0, "unknown")
    driver.reset([np.random.default_rng(0)])
    command, twist = np.zeros((1, AGENTS, 2)), np.zeros((1, AGENTS), np.bool_)
    began = 0.0
    for step in range(WARM + STEPS):
        if step == WARM:
            began = perf_counter()
        driver.act(command, step * DT)
        simulation.step(command, twist)
    return perf_counter() - began


def crowd_world() -> Any:
    """Return the circle as a world without walls."""
    import numpy as np

    from benchnav.arena.agents import Agents
    from benchnav.arena.sensing import NeighbourSensor, Sensing
    from benchnav.arena.world import Afterwards, Charge, Clock, ContactRule, Rules, World

    start = np.array(places())
    same, none = np.ones(AGENTS), np.zeros(AGENTS, np.int64)
    agents = Agents(
        start, np.zeros(AGENTS), -start, RADIUS * same, LIMIT * same, SPEED * same, same,
        none.astype(np.int8), none.astype(np.int8), none, none,
    )  # fmt: skip
    rules = Rules(0.1, ContactRule.SLIDE, Afterwards.STAY, Afterwards.STAY, Charge.BOTH)
    sensing = Sensing(None, NeighbourSensor(NEIGHBOURS, RANGE), None)
    reach = 1.2 * CIRCLE
    return World(
        (-reach, -reach, reach, reach), (), (), agents, ("crowd",), np.ones((1, 1), np.bool_),
        Clock(DT, 1, 10 * (WARM + STEPS)), rules, sensing,
    )  # fmt: skip


def pyrvo() -> float:
    """Return the time of STEPS steps [s]."""
    from pyrvo import RVOSimulator

    simulator, start = RVOSimulator(), places()
    simulator.set_time_step(DT)
    simulator.set_agent_defaults(RANGE, NEIGHBOURS, HORIZON, HORIZON, RADIUS, LIMIT)
    for place in start:
        simulator.add_agent(place)
    seconds = 0.0
    for step in range(WARM + STEPS):
        for k, (sx, sy) in enumerate(start):
            x, y = simulator.get_agent_position(k).to_tuple()
            dx, dy = -sx - x, -sy - y
            scale = SPEED / max(math.hypot(dx, dy), SPEED)
            simulator.set_agent_pref_velocity(k, (scale * dx, scale * dy))
        began = perf_counter()
        simulator.do_step()
        if step >= WARM:
            seconds += perf_counter() - began
    return seconds


def navground() -> float:
    """Return the time of STEPS steps [s]."""
    from navground import core, sim

    world = sim.World()
    for k, (x, y) in enumerate(places()):
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
    for step in range(WARM + STEPS):
        if step == WARM:
            began = perf_counter()
        world.update(DT)
    return perf_counter() - began


PARTS = {"benchnav": benchnav, "pyrvo": pyrvo, "navground": navground}


def answer(part: str) -> dict[str, Any]:
    """Return the output of a subprocess: seconds, or the reason why there are none."""
    try:
        return {"version": version(part), "seconds": PARTS[part]()}
    except (ImportError, PackageNotFoundError) as error:
        return {"skipped": f"{part} is not installed ({error})"}


def ask(python: str, part: str) -> dict[str, Any]:
    """Run one part in a separate interpreter.

    It runs as a module: the folder of a script would be first on the path, and one of our files
    may have the name of a package that a library imports.
    """
    command = [python, "-m", "benchmarks.orca_peers", "--part", part]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=ROOT)
    if done.returncode != 0 or not done.stdout:
        last = done.stderr.strip().splitlines()[-1:] or ["no output"]
        return {"skipped": f"{part} failed: {last[0]}"}
    times: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return times


def measure(peers_python: str) -> list[dict[str, Any]]:
    """Return a row for each part: agent-steps per second, and the ratio of benchnav to it.

    Rows have ``name``, ``version``, ``agent_steps_per_second``, ``ratio`` and ``wanted``
    (the ratio to reach), or ``name`` and ``skipped`` (the reason).
    """
    pythons = {"benchnav": sys.executable, "pyrvo": peers_python, "navground": peers_python}
    rounds: dict[str, list[dict[str, Any]]] = {part: [] for part in PARTS}
    for _ in range(ROUNDS):
        for part, python in pythons.items():
            if not (rounds[part] and "skipped" in rounds[part][0]):
                rounds[part].append(ask(python, part))
    best = {part: _best(times) for part, times in rounds.items()}
    ours = best["benchnav"].get("agent_steps_per_second")
    for part, wanted in (("pyrvo", 4.0), ("navground", 40.0)):
        if ours is not None and "skipped" not in best[part]:
            best[part]["ratio"] = ours / best[part]["agent_steps_per_second"]
            best[part]["wanted"] = wanted
    return [{"name": part, **row} for part, row in best.items()]


def _best(times: list[dict[str, Any]]) -> dict[str, Any]:
    skipped = next((one for one in times if "skipped" in one), None)
    if skipped is not None:
        return skipped
    seconds = min(float(one["seconds"]) for one in times)
    rate = AGENTS * STEPS / seconds
    return {"version": times[0]["version"], "agent_steps_per_second": rate}


if __name__ == "__main__":
    if sys.argv[1:2] == ["--part"]:
        print(json.dumps(answer(sys.argv[2])))
    else:
        for row in measure(sys.argv[1]):
            print(row)
