"""Every registered plugin, by name, passes the checks that are shipped to plugin authors."""

import sys
from pathlib import Path

import pytest

from benchnav.plugins import CONTROLLERS, METRICS, NAVIGATORS, PLANNERS
from benchnav.testing.check_controller import check_controller
from benchnav.testing.check_metric import check_metric
from benchnav.testing.check_navigator import check_navigator
from benchnav.testing.check_planner import check_planner

POLICY = Path(__file__).parents[1] / "reference" / "policy.zip"
GIVEN = {  # what cannot be made by its name alone
    "hierarchical": {
        "type": "hierarchical",
        "planner": "grid.astar",
        "controller": "path-following",
    },
    "policy": {"type": "policy", "file": str(POLICY), "encoder": "ego"},
    "process": {
        "type": "process",
        "command": [sys.executable, "-m", "benchnav.isolation.host", "orca"],
    },
}


@pytest.mark.parametrize("name", NAVIGATORS.names())
def test_navigator(name):
    check_navigator(GIVEN.get(name, name))


@pytest.mark.parametrize("name", PLANNERS.names())
def test_planner(name):
    check_planner(name)


@pytest.mark.parametrize("name", CONTROLLERS.names())
def test_controller(name):
    check_controller(name)


@pytest.mark.parametrize("name", METRICS.names())
def test_metric(name):
    check_metric(METRICS.load(name))


def test_nothing_that_ships_is_missing_or_broken():
    for registry in (NAVIGATORS, PLANNERS, CONTROLLERS, METRICS):
        assert registry.names()
        assert list(registry.broken()) == []


@pytest.mark.parametrize(
    "spec",
    [
        f"{planner}+{controller}"
        for planner in ("ompl.rrt-connect", "ompl.prm", "none", "mapping+ompl.rrt-connect")
        for controller in CONTROLLERS.names()
    ],
)
def test_any_planner_with_any_controller_is_a_navigator(spec):
    check_navigator(spec)
