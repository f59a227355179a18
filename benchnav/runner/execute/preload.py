"""The preloading of modules and kernels in the fork server, before it forks.

The kernels of the step contain all dynamics and footprints. Those of noisy senses are left out,
because most runs do not use them: the first noisy run compiles them, or `doctor --warm`.
"""

import gc
import os
from collections.abc import Callable, Iterable, Iterator
from functools import cache, partial

import numpy as np

from benchnav.arena.world import World
from benchnav.generation.build import build
from benchnav.geometry.geodesic import geodesic_lengths
from benchnav.kernels import cache_folder
from benchnav.metrics.measure import own_metrics
from benchnav.navigation.navigator import Need
from benchnav.navigation.observe import deciding, observe
from benchnav.runner.execute.measurement import measured
from benchnav.runner.rollouts.recorder import Recorder
from benchnav.runner.rollouts.rollout import Assignment
from benchnav.scenario.load import scenario_from_text
from benchnav.store.parts.episodes import from_table, to_table
from benchnav.system.pandas_import import delay_pandas
from benchnav.threads import core_count
from benchnav.world.command import give_commands
from benchnav.world.simulation import Simulation

Part = Callable[[], None]
_DECISIONS = 3
_RARE_COLLECTION = 200_000, 20, 50  # thresholds of the garbage collector while kernels compile
_SCENARIO = """
name: warm/crowd
version: 1
title: Uses every kernel of a run once
description: Few agents among static and dynamic obstacles
bounds: [-10, -10, 10, 10]
static:
  - {shape: {type: box, width: 1}, count: 2, region: {type: anywhere, margin: 1}}
dynamic:
  - shape: {type: disc, radius: 0.5}
    count: 1
    region: {type: anywhere, margin: 1}
    law: {type: back-and-forth, length: 3, speed: 1}
teams:
  - name: agents
    role: leader
    count: 3
    radius: 0.5
    dynamics: unicycle
    max_speed: 2
    max_turn_rate: 2.5
    start: {type: region, region: {type: anywhere}, separation: 0.5}
    goal: {type: region, region: {type: anywhere}, min_distance: 4}
clock: {dt: 0.2, substeps: 2, horizon: 2}
rules: {goal_tolerance: 0.5, contact: end, on_arrival: vanish, on_end: vanish}
"""


def warm() -> Iterator[int | None]:
    """Use the kernels of a run once, in steps.

    If none is compiled yet, a second process uses them in the opposite order: each process loads
    from the cache what the other one has compiled. Yields its process number once.
    """
    yield None
    delay_pandas()
    sensors: list[Part] = [partial(_observe, need) for need in sorted(Need)]
    parts: list[Part] = [_measure, *sensors, _find_path]
    folder = cache_folder("benchnav")
    thresholds = gc.get_threshold()
    if folder is not None and not folder.exists():
        gc.set_threshold(*_RARE_COLLECTION)  # a compiler's many objects live until it ends
        if core_count() > 1:
            yield _started(reversed(parts))
    try:
        for part in parts:
            part()
            yield None
    finally:
        gc.set_threshold(*thresholds)


def _started(parts: Iterable[Part]) -> int:
    """Start a process that runs ``parts``; return its number."""
    pid = os.fork()
    if not pid:
        try:
            for part in parts:
                part()
        finally:
            os._exit(0)
    return pid


@cache
def _world() -> World:
    return build(scenario_from_text(_SCENARIO, "warm.yaml"), "train", 0)


def _observe(need: Need) -> None:
    """Sense once in a small world."""
    simulation = Simulation([_world()])
    chosen = np.arange(simulation.A)[None]
    observe(simulation, chosen, deciding(simulation, chosen), frozenset([need]), (None,))


def _measure() -> None:
    """Step, record, store and measure a small world."""
    simulation = Simulation([_world()])
    recorder = Recorder(simulation)
    recorder.record_state()
    chosen = np.arange(simulation.A)[None]
    for _ in range(_DECISIONS):
        command = np.zeros_like(simulation.position)
        active = deciding(simulation, chosen)
        give_commands(0, 1, np.arange(1), chosen, active, command + 0.5, command)
        executed = simulation.step(command, np.zeros(simulation.present.shape, np.bool_))
        recorder.record_commands(command, executed, 0.0)
        recorder.record_state()
    assignment = Assignment("warm/crowd@1", "", "train", "known", "none", "none")
    episode = recorder.episodes([assignment.identity(0)], 0.0, "", True, [()])[0]
    measured(from_table(to_table([episode])), own_metrics())


def _find_path() -> None:
    """Search a path around a square."""
    x, y = np.array([[-1.0, 1.0, 1.0, -1.0], [-1.0, -1.0, 1.0, 1.0]])
    square = np.stack([x, y, np.roll(x, -1), np.roll(y, -1), np.zeros(4)], axis=1)
    ends = np.array([[-3.0, 0.0]]), np.array([[3.0, 0.0]])
    geodesic_lengths(square, *ends, np.array([0.5]), 0.5)
