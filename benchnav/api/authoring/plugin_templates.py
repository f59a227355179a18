"""The files of new packages of navigators, planners, controllers, metrics and scenarios."""

from benchnav.api.authoring.free_name import class_name, module_name

_PROJECT = """\
[build-system]
requires = ["setuptools>=80"]
build-backend = "setuptools.build_meta"

[project]
name = "{name}"
version = "0.1.0"
description = "A {title} for benchnav"
readme = "README.md"
requires-python = ">=3.11"
dependencies = ["benchnav"]

[project.optional-dependencies]
test = ["pytest"]

[project.entry-points."benchnav.{group}"]
{entry}
"""

_README = """\
# {name}

A {title} for [benchnav](https://pypi.org/project/benchnav/). Its code is in `src/{module}.py`.

    pip install -e ".[test]"
    pytest
    benchnav show {shown}
{use}

The test calls `{check}`, which reports violated rules in sentences.
"""

_NAVIGATOR = '''\
"""The navigator {name} for benchnav."""

from benchnav.navigation.navigator import AgentNavigator, PluginConfig
from pydantic import Field


class {cls}(AgentNavigator):
    """Walk straight to the goal and slow down near it. Replace `act_agent` with your idea."""

    class Config(PluginConfig):
        pace: float = Field(1.0, gt=0, le=1, description="share of the preferred speed")

    def act_agent(self, view, briefing):
        """Return the velocity [m/s] of one agent, in the world frame."""
        way = view.goal - view.position
        speed = self.config.pace * briefing.preferred_speed[view.agent]
        return way * min(speed / max((way @ way) ** 0.5, 1e-9), 1 / briefing.dt)
'''

_PLANNER = '''\
"""The planner {name} for benchnav."""

from collections import deque

import numpy as np
from benchnav.geometry.sweep import motion_is_free
from benchnav.navigation import UNSOLVED, Plan, Planner, PluginConfig
from pydantic import Field

STEPS = [(x, y) for x in (-1, 0, 1) for y in (-1, 0, 1) if x or y]


class {cls}(Planner):
    """Search a square lattice around the start, breadth first. Replace `plan` with your idea."""

    class Config(PluginConfig):
        cell: float = Field(0.5, gt=0, description="[m] step of the lattice")

    def plan(self, map, start, goal, radius, tolerance, rng):
        """Return a path (W, 2) [m] of a disc of this radius [m], or an unsolved plan."""

        def is_free(p, q):
            return motion_is_free(*p.tolist(), *q.tolist(), radius, map.capsules)

        cell, low, high = self.config.cell, np.array(map.bounds[:2]), np.array(map.bounds[2:])
        before, queue = {{(0, 0): None}}, deque([(0, 0)])
        while queue:
            node = queue.popleft()
            place = start + cell * np.array(node)
            if np.hypot(*(goal - place)) <= 2 * cell and is_free(place, goal):
                return Plan(self.path(before, node, start, goal), True, checks=len(before))
            for x, y in STEPS:
                near = node[0] + x, node[1] + y
                there = start + cell * np.array(near)
                inside = (low <= there).all() and (there <= high).all()
                if near not in before and inside and is_free(place, there):
                    before[near] = node
                    queue.append(near)
        return Plan(UNSOLVED, False, checks=len(before), reason="no way on the lattice")

    def path(self, before, node, start, goal):
        """Return the way through the lattice to a node, and on to the goal."""
        way = [goal]
        while node is not None:
            way.append(start + self.config.cell * np.array(node))
            node = before[node]
        return np.array(way[::-1])
'''

_CONTROLLER = '''\
"""The controller {name} for benchnav."""

import numpy as np
from benchnav.navigation import Controller, PluginConfig, RowTable
from pydantic import Field


class {cls}(Controller):
    """Drive to the next point of the path. Replace `steer` with your idea."""

    class Config(PluginConfig):
        pace: float = Field(1.0, gt=0, le=1, description="share of the preferred speed")

    def __init__(self, config=None):
        super().__init__(config)
        self.table = RowTable()  # what is known of the agents of each world

    def reset(self, briefings, rows):
        """Start the worlds ``rows`` (N,)."""
        for row, briefing in zip(rows, briefings, strict=True):
            step = np.full(len(briefing), briefing.dt)
            self.table.put(int(row), speed=briefing.preferred_speed, dt=step)

    def steer(self, observation, guide):
        """Return velocities (B, A, 2) [m/s] of all agents, in the world frame."""
        agents = observation.active.shape[1]
        speed, dt = (self.table.take(key, observation.rows, agents) for key in ("speed", "dt"))
        way = guide.target - observation.position
        far = np.maximum(np.sqrt((way * way).sum(axis=2)), 1e-9)
        return way * np.minimum(self.config.pace * speed / far, 1 / np.maximum(dt, 1e-9))[..., None]
'''

_METRIC = '''\
"""The metric {metric} for benchnav."""

import numpy as np
from benchnav.metrics.metric import metric
from benchnav.metrics.quantities.episode_analysis import analyse


@metric(title="Mean speed until arrival", unit="m/s", better=None, low=0.0, conditional=True)
def {metric}(episode):
    """(A,) [m/s] mean speed of each agent; NaN for an agent that does not arrive."""
    found = analyse(episode)  # computed once per episode, for all metrics
    return np.where(found.arrived, found.trajectories.length / found.arrival, np.nan)
'''

_CHECK = '''\
"""The rules that every {title} keeps, as benchnav checks them."""

from benchnav.testing.check_{title} import check_{title}
{imported}

def test_it_keeps_the_rules_of_a_{title}():
    check_{title}({subject})
'''

_PACK_README = """\
# {name}

Scenarios and a suite for [benchnav](https://pypi.org/project/benchnav/), in `src/{module}`: the
files in `{name}` are scenarios, those in `suites` are suites.

    pip install -e ".[test]"
    pytest
    benchnav show {name}/crossing
    benchnav run {name} --out runs/first
    benchnav leaderboard runs/first

The test validates each file and draws its worlds.
"""

_PACK_DATA = """
[tool.setuptools.package-data]
{module} = ["**/*.yaml"]
"""

_SCENARIO = """\
name: {name}/crossing
version: 1
title: Agents cross a square around a pillar
parameters:
  agents: {{default: 8, low: 2, high: 20, description: on the circle}}
bounds: [-6, -6, 6, 6]
walls:
  - shape: {{type: disc, radius: 0.8}}
teams:
  - name: crowd
    count: {{parameter: agents}}
    radius: 0.25
    max_speed: 1.2
    start: {{type: circle, radius: 5, jitter: 0.2}}
    goal: {{type: antipodal}}
clock: {{dt: 0.2, substeps: 2, horizon: 60}}
"""

_SUITE = """\
name: {name}
description: The scenarios of {name}
scenarios: [{name}/crossing]
navigators: [straight-line, orca]
tracks: [known]
seeds: 3
"""

_PACK_TEST = '''\
"""Each scenario and suite of the package is valid."""

from pathlib import Path

import benchnav
import pytest

FILES = sorted((Path(__file__).parents[1] / "src" / "{module}").rglob("*.yaml"))


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_it_is_valid(file):
    found = benchnav.validate(file)
    assert found.valid, found.text()
'''


def navigator_package(name: str) -> dict[str, str]:
    """Return path → text of a package with a navigator."""
    use = f"    benchnav run quick --navigator {name} --navigator orca --out runs/first\n"
    use += "    benchnav leaderboard runs/first"
    return _package(name, "navigator", _NAVIGATOR, _class_entry(name), name, use, f'"{name}"', "")


def planner_package(name: str) -> dict[str, str]:
    """Return path → text of a package with a planner."""
    use = f"    benchnav run quick --navigator {name}+orca --navigator orca --out runs/first"
    return _package(name, "planner", _PLANNER, _class_entry(name), name, use, f'"{name}"', "")


def controller_package(name: str) -> dict[str, str]:
    """Return path → text of a package with a controller."""
    use = f"    benchnav run quick --navigator grid.astar+{name} --navigator orca --out runs/first"
    return _package(name, "controller", _CONTROLLER, _class_entry(name), name, use, f'"{name}"', "")


def metric_package(name: str) -> dict[str, str]:
    """Return path → text of a package with a metric, whose name has underscores."""
    metric = module_name(name)
    use = f"    benchnav leaderboard RUN --recompute --metric {metric}"
    imported = f"from {metric} import {metric}\n"
    entry = f'{metric} = "{metric}:{metric}"'
    return _package(name, "metric", _METRIC, entry, metric, use, metric, imported)


def scenario_package(name: str) -> dict[str, str]:
    """Return path → text of a package with a scenario and a suite."""
    module = module_name(name)
    words = {"name": name, "module": module}
    entries = (
        f'{name} = "{module}"\n\n[project.entry-points."benchnav.suites"]\n{name} = "{module}"'
    )
    project = _PROJECT.format(name=name, title="scenario pack", group="scenarios", entry=entries)
    return {
        "pyproject.toml": project + _PACK_DATA.format(**words),
        "README.md": _PACK_README.format(**words),
        f"src/{module}/__init__.py": f'"""Scenarios and suites of {name}."""\n',
        f"src/{module}/{name}/crossing.yaml": _SCENARIO.format(**words),
        f"src/{module}/suites/{name}.yaml": _SUITE.format(**words),
        f"tests/test_{module}.py": _PACK_TEST.format(**words),
    }


def _class_entry(name: str) -> str:
    return f'{name} = "{module_name(name)}:{class_name(name)}"'


def _package(
    name: str, title: str, code: str, entry: str, shown: str, use: str, subject: str, imported: str
) -> dict[str, str]:
    module = module_name(name)
    words = {
        "name": name, "module": module, "cls": class_name(name), "metric": module, "title": title,
        "group": f"{title}s", "entry": entry, "shown": shown, "use": use,
        "check": f"check_{title}", "subject": subject, "imported": imported,
    }  # fmt: skip
    texts = {
        "pyproject.toml": _PROJECT, "README.md": _README, f"src/{module}.py": code,
        f"tests/test_{module}.py": _CHECK,
    }  # fmt: skip
    return {path: text.format(**words) for path, text in texts.items()}
