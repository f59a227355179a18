"""What registries refuse at once, and what they call broken."""

import math
import os
import re
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

import benchnav
from benchnav.errors import BrokenPluginError, PluginConflictError, PluginError
from benchnav.metrics.efficiency import spl
from benchnav.metrics.metric import OWN, Metric, metric
from benchnav.metrics.success import success
from benchnav.navigation.navigator import Navigator
from benchnav.plugins import CONTROLLERS, METRICS, NAVIGATORS, PLANNERS, TRAINERS
from benchnav.testing.zoo import zoo


class Still(Navigator):
    def act(self, observation):
        return observation.velocity * 0


class Unfinished(Navigator):
    pass


class WithoutConfig(Still):
    Config = None


@pytest.mark.parametrize(
    ("thing", "rule"),
    [
        (dict, "be a class derived from benchnav.navigation.navigator.Navigator. Got the class"),
        (len, "be a class derived from .* Got the builtin_function_or_method len"),
        (Unfinished, "be a class that implements act"),
        (WithoutConfig, "be a class with a pydantic Config"),
        (PLANNERS.load("visibility"), "be a class derived from .*Navigator"),
        (CONTROLLERS.load("orca"), "be a class derived from .*Navigator"),
        (Still(), "be a class derived from .*Navigator. Got a Still"),
    ],
)
def test_a_navigator_that_a_run_would_refuse_is_refused_at_once(thing, rule):
    with pytest.raises(BrokenPluginError, match=f"The navigator 'mine' must {rule}"):
        benchnav.register_navigator("mine")(thing)
    assert "mine" not in NAVIGATORS.names()


def test_planners_and_controllers_are_held_to_their_own_contracts():
    with pytest.raises(BrokenPluginError, match=r"benchnav.navigation.planner.Planner"):
        benchnav.register_planner("mine")(Still)
    with pytest.raises(BrokenPluginError, match=r"benchnav.navigation.controller.Controller"):
        benchnav.register_controller("mine")(Still)


@pytest.mark.parametrize(
    ("thing", "rule"),
    [
        (
            success.function,
            "be a benchnav.metrics.metric.Metric, as the decorator .* Got the function success",
        ),
        (success, "carry that name, and not 'success'"),
        (replace(success, name="mine", better="up"), "be better 'higher', 'lower' or None"),
        (replace(success, name="mine", function=3), "have a function, and not 3"),
    ],
)
def test_a_metric_that_a_run_would_refuse_is_refused_at_once(thing, rule):
    with pytest.raises(PluginError, match=rule):
        benchnav.register_metric("mine")(thing)
    assert "mine" not in METRICS.names()


def test_a_module_of_benchnav_stands_for_every_metric_that_it_defines():
    assert METRICS.source("spl").value == "benchnav.metrics.efficiency:spl"
    assert METRICS.load("spl") is spl
    assert "efficiency" in METRICS.names()  # the metric
    assert "congestion" not in METRICS.names()  # the module


def test_a_metric_is_made_of_a_function_and_is_called_like_it():
    @metric(title="Steps", unit="", better=None, low=0.0)
    def steps(episode):
        """How many decisions there were."""
        return len(episode.status) * np.ones(2)

    assert isinstance(steps, Metric)
    assert (steps.name, steps.low, steps.high) == ("steps", 0.0, math.inf)
    assert (steps.reference, steps.scope, steps.__doc__) == (OWN, "agent", steps.function.__doc__)
    assert steps(zoo()["smooth"])[0] == len(zoo()["smooth"].status)


@pytest.mark.parametrize("name", [Still, None, "", "  ", "module:Class"])
def test_a_name_must_be_one(name):
    with pytest.raises(PluginError, match=r"@benchnav.register_navigator\('my-name'\)"):
        benchnav.register_navigator(name)


def test_names_that_are_taken_are_refused():
    with pytest.raises(PluginConflictError, match="'orca' is claimed more than once"):
        benchnav.register_navigator("orca")(Still)
    with pytest.raises(PluginConflictError, match="'success' is claimed more than once"):
        benchnav.register_metric("success")(success)


def test_a_cell_of_a_notebook_can_be_run_again():
    def mine(episode):
        return episode.arrival

    for _ in range(2):
        benchnav.register_metric("mine")(replace(success, name="mine", function=mine))

    def other(episode):
        return episode.arrival

    with pytest.raises(PluginConflictError):
        benchnav.register_metric("mine")(replace(success, name="mine", function=other))


def test_all_that_ships_fulfils_its_contract():
    for registry in (NAVIGATORS, PLANNERS, CONTROLLERS, METRICS, TRAINERS):
        assert list(registry.broken()) == []


ENTRIES = """
[benchnav.navigators]
draws = random:Random
planner = benchnav_baselines.planners.visibility:Visibility
leaves = plugin_that_leaves:Navigator
[benchnav.metrics]
odd = benchnav.metrics.success:success_time
whole = metrics_of_a_plugin
[benchnav.trainers]
odd = random:Random
"""
CODE = "from benchnav.cli.main import main; main()"


@pytest.fixture
def call(tmp_path):
    """The command, where a distribution is installed whose plugins are of the wrong type."""
    folder = tmp_path / "odd-0.1.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_text("Metadata-Version: 2.1\nName: odd\nVersion: 0.1\n")
    (folder / "entry_points.txt").write_text(ENTRIES)
    (tmp_path / "plugin_that_leaves.py").write_text("raise SystemExit('bye')\n")
    (tmp_path / "metrics_of_a_plugin.py").write_text("print('imported')\n")

    def call(*arguments):
        done = subprocess.run(
            [sys.executable, "-c", CODE, *arguments], capture_output=True, text=True, check=False,
            env={**os.environ, "PYTHONPATH": str(tmp_path)},
        )  # fmt: skip
        assert "Traceback" not in done.stderr
        return done.returncode, done.stdout, done.stderr

    return call


def test_plugins_of_the_wrong_type_are_listed_as_broken(call):
    code, stdout, _ = call("list", "navigators")
    assert code == 0
    rows = {line.split()[0]: line for line in stdout.splitlines()}
    assert "broken" in rows["draws"]
    assert "must be a class derived from" in rows["draws"]
    assert "Got the class Random (random:Random, from odd 0.1)" in rows["draws"]
    assert "broken" in rows["planner"]
    assert "SystemExit: bye" in rows["leaves"]
    assert "broken" not in rows["orca"]


def test_a_module_of_a_plugin_is_not_imported_for_names_and_is_no_metric(call):
    code, stdout, stderr = call("list", "metrics")
    (row,) = (line for line in stdout.splitlines() if line.startswith("whole "))
    assert "must be named as one metric, metrics_of_a_plugin:whole" in row
    code, stdout, stderr = call("show", "orca")
    assert (code, "imported" in stdout + stderr) == (0, False)


def test_doctor_counts_plugins_of_the_wrong_type_as_broken(call):
    code, stdout, _ = call("doctor")
    assert code == 1
    wrong = [line for line in stdout.splitlines() if line.startswith("WRONG")]
    assert [line.split()[1] for line in wrong] == [
        *["navigator"] * 3,
        "metric",
        "metric",
        "trainer",
    ]
    usable = len(NAVIGATORS.names())
    assert re.search(rf"navigators +{usable} can be used", stdout)


@pytest.mark.parametrize(
    "arguments", [("show", "draws"), ("show", "odd"), ("run", "quick", "--navigator", "planner")]
)
def test_a_plugin_of_the_wrong_type_is_refused_with_its_cause(call, arguments):
    code, stdout, stderr = call(*arguments)
    assert (code, stdout) == (2, "")
    assert "must be a" in stderr
    assert "from odd 0.1" in stderr


def test_a_broken_trainer_hides_no_recipe(call):
    code, _, stderr = call("train", "dynamik")
    assert code == 2
    assert "Did you mean 'dynamic'" in stderr
