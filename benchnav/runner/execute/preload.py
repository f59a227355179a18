"""The preloading of modules and kernels in the fork server, before it forks."""

from collections.abc import Generator, Iterator

import numpy as np

from benchnav.arena.world import World
from benchnav.episode.episode import Episode
from benchnav.generation.build import build
from benchnav.geometry.geodesic import geodesic_lengths
from benchnav.metrics.measure import own_metrics
from benchnav.navigation.navigator import Need
from benchnav.navigation.observe import deciding, observe
from benchnav.runner.execute.measurement import measured
from benchnav.runner.rollouts.recorder import Recorder
from benchnav.runner.rollouts.rollout import Assignment
from benchnav.scenario.load import scenario_from_text
from benchnav.store.parts.episodes import from_table, to_table
from benchnav.system.pandas_import import delay_pandas
from benchnav.world.command import give_commands
from benchnav.world.simulation import Simulation

_DECISIONS = 3
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


def warm() -> Iterator[None]:
    """Build, sense, step, record, store and measure one small world, in steps."""
    yield
    delay_pandas()
    scenario = scenario_from_text(_SCENARIO, "warm.yaml")
    world = build(scenario, "train", 0)
    yield
    episode = yield from _episode(world)
    yield
    measured(from_table(to_table([episode])), own_metrics())
    _find_path()


def _episode(world: World) -> Generator[None, None, Episode]:
    simulation = Simulation([world])
    recorder = Recorder(simulation)
    recorder.record_state()
    chosen = np.arange(simulation.A)[None]
    for _ in range(_DECISIONS):
        active = deciding(simulation, chosen)
        observe(simulation, chosen, active, frozenset(Need), (None,))
        yield
        command = np.zeros_like(simulation.position)
        give_commands(0, 1, np.arange(1), chosen, active, command + 0.5, command)
        executed = simulation.step(command, np.zeros(simulation.present.shape, np.bool_))
        recorder.record_commands(command, executed, 0.0)
        recorder.record_state()
    assignment = Assignment("warm/crowd@1", "", "train", "known", "none", "none")
    return recorder.episodes([assignment.identity(0)], 0.0, "", True, [()])[0]


def _find_path() -> None:
    """Search a path around a square."""
    x, y = np.array([[-1.0, 1.0, 1.0, -1.0], [-1.0, -1.0, 1.0, 1.0]])
    square = np.stack([x, y, np.roll(x, -1), np.roll(y, -1), np.zeros(4)], axis=1)
    ends = np.array([[-3.0, 0.0]]), np.array([[3.0, 0.0]])
    geodesic_lengths(square, *ends, np.array([0.5]), 0.5)
