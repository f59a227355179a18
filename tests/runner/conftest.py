"""A tiny scenario, and navigators that misbehave."""

import sys
from dataclasses import replace

import numpy as np
import pytest

from benchnav.generation.build import build
from benchnav.runner.rollouts.rollout import Assignment, rollout
from benchnav.scenario.load import load_scenario

SCENARIO = """
name: tiny/crossing
title: Four discs that change places
bounds: [-4, -4, 4, 4]
static:
  - shape: {type: disc, radius: 0.4}
    count: {integers: [0, 2]}
    region: {type: anywhere, margin: 1}
dynamic:
  - shape: {type: box, width: 0.5}
    count: 1
    region: {type: anywhere, margin: 1}
    law: {type: back-and-forth, length: 2, speed: 0.7}
teams:
  - name: us
    count: {integers: [1, 3]}
    radius: 0.3
    max_speed: 1
    start: {type: region, region: {type: anywhere}, separation: 0.3}
    goal: {type: region, region: {type: anywhere}, min_distance: 3}
  - name: them
    count: 1
    radius: 0.3
    max_speed: 1
    driver: straight-line
    start: {type: region, region: {type: anywhere}, separation: 0.3}
    goal: {type: region, region: {type: anywhere}, min_distance: 3}
clock: {dt: 0.2, substeps: 2, horizon: 8}
"""

NAVIGATORS = '''
"""Navigators that fail in some worlds only: those whose first agent starts in the east."""

import multiprocessing
import os
import signal
import sys
import time

import numpy as np

from benchnav.errors import MissingExtraError
from benchnav.navigation.navigator import AgentNavigator, Navigator


class Walk(Navigator):
    """Random steps from the briefing's generator; fails at t = 0.6 s in the east."""

    def reset(self, briefings, rows):
        self.told = getattr(self, "told", {})
        for row, briefing in zip(rows, briefings):
            self.told[int(row)] = briefing

    def act(self, observation):
        command = np.zeros((*observation.active.shape, 2))
        for b, row in enumerate(observation.rows):
            briefing = self.told[int(row)]
            command[b, : len(briefing)] = briefing.rng.normal(size=(len(briefing), 2))
            if briefing.start[0, 0] > 0 and observation.time[b] > 0.5:
                command = self.fail(command, b)
        return command

    def fail(self, command, b):
        return command


class Raises(Walk):
    def fail(self, command, b):
        raise ValueError("lost my\\nway")


class Nan(Walk):
    def fail(self, command, b):
        command[b, 0, 1] = np.nan
        return command


class Shape(Walk):
    def fail(self, command, b):
        return command[:, :, :1]


class Nothing(Walk):
    def fail(self, command, b):
        return None


class Leaves(Walk):
    def fail(self, command, b):
        sys.exit("bye")


class Dies(Walk):
    def fail(self, command, b):
        os._exit(7)


class Crashes(Walk):
    def fail(self, command, b):
        os.kill(os.getpid(), signal.SIGSEGV)


class Sleeps(Walk):
    def fail(self, command, b):
        time.sleep(3600)


class Slow(Walk):
    def act(self, observation):
        time.sleep(0.03)
        return super().act(observation)


class Spins(Walk):
    """Hangs in C and never lets go of the interpreter."""

    def fail(self, command, b):
        return 7 ** (10**9)


class Leaks(Walk):
    kept = []

    def fail(self, command, b):
        self.kept.append(np.ones(12_500_000))
        return command


class Hoards(Walk):
    """Keeps a little of every world that its process ever saw."""

    kept = []

    def reset(self, briefings, rows):
        super().reset(briefings, rows)
        self.kept += [np.ones(25_000_000) for _ in briefings]


class NotThere(Walk):
    """Cannot be made in a worker."""

    def __init__(self, config=None):
        super().__init__(config)
        if "benchnav.runner.execute.worker" in sys.modules:
            raise OSError("not there")


class ResetRaises(Walk):
    def reset(self, briefings, rows):
        super().reset(briefings, rows)
        if any(b.start[0, 0] > 0 for b in briefings):
            raise RuntimeError("no plan")


class Vandal(Walk):
    """Writes into all that it is shown."""

    def act(self, observation):
        command = super().act(observation)
        for array in (observation.position, observation.velocity, observation.goal,
                      observation.heading, observation.active, observation.time):
            array[...] = 0
        for b in self.told.values():
            b.goal[...] = 0.0
            b.max_speed[...] = 99.0
        return command


class Talks(Walk):
    def act(self, observation):
        print("hello from a navigator")
        return super().act(observation)


class Staggered(Navigator):
    """Fails in every world, in each at a time of its own: raises, or answers NaN."""

    how, resets = "nan", []

    def reset(self, briefings, rows):
        self.when = {int(r): 0.2 * (1 + rank(b) % 37) for r, b in zip(rows, briefings)}
        self.resets.extend(rank(b) for b in briefings)

    def act(self, observation):
        command = np.zeros((*observation.active.shape, 2))
        for b, row in enumerate(observation.rows):
            if observation.time[b] > self.when[int(row)]:
                if self.how == "raise":
                    raise ValueError("now")
                command[b, 0] = np.nan
        return command


def rank(briefing):
    """A number that differs from world to world."""
    return int(abs(briefing.start[0, 0]) * 1e9)


class Alone(Walk):
    """Only knows one world at a time."""

    def act(self, observation):
        if len(observation) > 1:
            raise IndexError("one at a time")
        return super().act(observation)


class Agentwise(AgentNavigator):
    def act_agent(self, view, briefing):
        way = view.goal - view.position
        return way / max(np.hypot(*way), 1e-9)


class Unfit(Walk):
    def reset(self, briefings, rows):
        raise MissingExtraError("Unfit", "plan")


class Unmade(Walk):
    def __init__(self, config=None):
        raise MissingExtraError("Unmade", "plan")


class Sees(Navigator):
    """Keeps what it is told and shown, for tests in this process."""

    briefed, shown = [], []

    def reset(self, briefings, rows):
        self.briefed.extend(briefings)

    def act(self, observation):
        self.shown.append(observation)
        return np.zeros((*observation.active.shape, 2))


class Rotor(Navigator):
    """Answers twists."""

    command = "twist"

    def act(self, observation):
        return np.tile([0.5, 0.3], (*observation.active.shape, 1))
'''


@pytest.fixture(scope="session")
def scenario(tmp_path_factory):
    path = tmp_path_factory.mktemp("scenario") / "tiny.yaml"
    path.write_text(SCENARIO)
    return load_scenario(path)


@pytest.fixture(scope="session")
def scenario_file(scenario):
    return scenario.folder / "tiny.yaml"


@pytest.fixture(scope="session")
def troubled(tmp_path_factory):
    """The module of `NAVIGATORS`, importable here and in worker processes."""
    folder = tmp_path_factory.mktemp("plugins")
    (folder / "troubled_navigators.py").write_text(NAVIGATORS)
    sys.path.insert(0, str(folder))
    yield folder
    sys.path.remove(str(folder))


@pytest.fixture
def play(scenario, troubled):
    """Seeds and a navigator → its episodes, by seed."""

    def play(navigator, seeds=range(6), track="known", charge="", worlds=None, **changes):
        spec = f"troubled_navigators:{navigator}" if navigator[0].isupper() else navigator
        assignment = Assignment(
            scenario.identity, scenario.hash, "test", track, navigator, spec,
            scenario.driver_specs,
        )  # fmt: skip
        worlds = worlds or [(seed, build(scenario, "test", seed)) for seed in seeds]
        episodes = rollout(replace(assignment, **changes), worlds, charge)
        found = {e.identity.seed: e for batch in episodes for e in batch}
        assert sorted(found) == sorted(seed for seed, _ in worlds)
        return found

    return play


def east(episode):
    """True where the misbehaving navigators misbehave."""
    agents = episode.world.agents
    return bool(agents.start[np.flatnonzero(agents.evaluated)[0], 0] > 0)


@pytest.fixture
def in_the_east():
    return east
