"""A navigator that cannot drive a body is n/a there, with the reason."""

from typing import get_args

import pytest

import benchnav
from benchnav.arena.agents import Dynamics
from benchnav.errors import UsageError
from benchnav.navigation.navigator import ALL_DYNAMICS, DynamicsName, Navigator
from benchnav.navigation.plugin.capabilities import Capabilities, undriven
from benchnav.navigation.plugin.configure import make
from benchnav.plugins import NAVIGATORS
from benchnav.runner.plan.suite import load_suite
from tests.plain_scenario import PLAIN

CAR = PLAIN + "    dynamics: {type: ackermann, wheelbase: 0.3, max_steering_angle: 0.6}\n"
POLICIES = "drives holonomic, unicycle and differential-drive bodies only"


@pytest.fixture
def scenario(tmp_path):
    path = tmp_path / "car.yaml"
    path.write_text(CAR)
    return path


def test_the_names_are_those_of_the_dynamics():
    names = [kind.name.lower().replace("_", "-") for kind in Dynamics]
    assert list(get_args(DynamicsName)) == names


@pytest.mark.parametrize(
    ("drives", "reason"),
    [
        (ALL_DYNAMICS, ""),
        ({"ackermann", "holonomic"}, ""),
        ({"holonomic"}, "drives holonomic bodies only"),
        ({"unicycle", "holonomic"}, "drives holonomic and unicycle bodies only"),
        (ALL_DYNAMICS - {"ackermann"}, POLICIES),
    ],
)
def test_the_reason_names_the_bodies_in_their_order(drives, reason):
    assert undriven(drives, {"ackermann"}) == reason


def test_learned_policies_are_not_available_for_cars(scenario, tmp_path):
    suite = tmp_path / "cars.yaml"
    names = ("orca", "navmesh+dwa", "q-learning", "visibility+orca-ppo", "map-orca-ppo")
    listed = ", ".join(names)
    suite.write_text(
        f"name: cars\nversion: 1\nscenarios: [{scenario}]\ntracks: [known]\n"
        f"navigators: [{listed}]\nseeds: 1\n"
    )
    reasons = {c.contestant.label: c.reason for c in load_suite(str(suite)).jobs()}
    assert {name: reasons[name] for name in names[:2]} == dict.fromkeys(names[:2], "")
    assert {reasons[name] for name in names[2:]} == {POLICIES}


def test_simulate_refuses_them_too(scenario):
    world = benchnav.load_scenario(str(scenario)).world(seed=0)
    with pytest.raises(UsageError, match="'q-learning' cannot be run here: drives holonomic,"):
        benchnav.simulate(world, "q-learning")


def test_a_pair_drives_what_its_controller_drives():
    assert make(NAVIGATORS, "navmesh+q-learning").drives == ALL_DYNAMICS - {"ackermann"}
    assert make(NAVIGATORS, "navmesh+orca").drives == ALL_DYNAMICS


def test_navigators_that_declare_nothing_drive_all_bodies():
    class Any(Navigator):
        def act(self, observation):
            return observation.velocity

    assert Any().drives == ALL_DYNAMICS
    assert Capabilities().drives == ALL_DYNAMICS
    only = Capabilities(drives=frozenset({"holonomic"}))
    text = only.model_dump_json(exclude_defaults=True)
    assert Capabilities.model_validate_json(text) == only


def test_show_names_the_bodies():
    assert f"drives      {POLICIES[7:-5]}" in str(benchnav.show("q-learning"))
    assert "drives      all bodies" in str(benchnav.show("orca"))
    assert "drives      all bodies" in str(benchnav.show("navmesh+orca"))
