"""Keys of dynamics: hashes, drawn columns, and one sentence for each mistake."""

import dataclasses

import numpy as np
import pytest

from benchnav.arena.agents import Dynamics
from benchnav.errors import ScenarioError
from benchnav.generation.build import build
from benchnav.generation.world_digest import world_digest
from benchnav.navigation.briefing import brief
from benchnav.scenario.load import scenario_from_text
from tests.plain_scenario import PLAIN

CAR = "dynamics: {type: ackermann, wheelbase: 0.3, max_steering_angle: 0.5}"
WHEELS = "dynamics: {type: differential-drive, track_width: 0.3, max_wheel_speed: 1}"


def with_keys(*lines):
    return scenario_from_text(PLAIN.replace("max_speed", "\n    ".join([*lines, "max_speed"])), "f")


def test_dynamics_as_text_and_as_a_mapping_are_one_scenario():
    hashes = {
        with_keys(*keys).hash
        for keys in ([], ["dynamics: holonomic"], ["dynamics: {type: holonomic}"],
                     ["max_acceleration: null"])
    }  # fmt: skip
    unicycle = with_keys("dynamics: unicycle")
    assert len(hashes) == 1
    assert with_keys("dynamics: {type: unicycle, reverse: false}").hash == unicycle.hash
    assert unicycle.model_dump(mode="json")["teams"][0]["dynamics"] == "unicycle"
    others = ["dynamics: {type: unicycle, reverse: true}", "max_acceleration: 1", CAR, WHEELS]
    assert len({*hashes, unicycle.hash, *(with_keys(key).hash for key in others)}) == 6


def test_limits_are_drawn_and_briefed():
    scenario = with_keys(
        "max_acceleration: {uniform: [1, 2]}", CAR[:-1] + ", max_steering_rate: 2, reverse: true}"
    )
    agents = build(scenario, "test", 0).agents
    assert agents.dynamics.tolist() == [Dynamics.ACKERMANN]
    assert 1.0 <= agents.max_acceleration[0] == agents.max_deceleration[0] < 2.0
    assert agents.max_turn_acceleration[0] == np.inf
    assert (agents.wheelbase[0], agents.max_steering_angle[0]) == (0.3, 0.5)
    assert (agents.max_steering_rate[0], agents.reverse[0]) == (2.0, True)
    told = brief(
        agents, np.array([0]), dt=0.2, horizon=1.0, goal_tolerance=0.1, decision_budget=None,
        map=None, rng=np.random.default_rng(),
    )  # fmt: skip
    assert told.wheelbase.tolist() == [0.3]
    assert told.max_wheel_speed.tolist() == [np.inf]


def test_columns_that_limit_nothing_are_not_in_a_digest():
    world = build(with_keys(), "test", 0)
    limits = {"max_acceleration": np.full(1, np.inf), "reverse": np.zeros(1, bool)}
    same = dataclasses.replace(world, agents=dataclasses.replace(world.agents, **limits))
    other = dataclasses.replace(
        world, agents=dataclasses.replace(world.agents, max_acceleration=np.ones(1))
    )
    assert world_digest(same) == world_digest(world) != world_digest(other)


@pytest.mark.parametrize(
    ("key", "sentence"),
    [
        ("dynamics: ackerman", "dynamics must have one of the types 'holonomic', 'unicycle',"
         " 'differential-drive', 'ackermann'; got 'ackerman'. Did you mean 'ackermann'?"),
        ("dynamics: differential-drive", "dynamics.track_width must be given.\n"
         "f:6: teams[0].dynamics.max_wheel_speed must be given."),
        (CAR.replace("0.3", "0"), "dynamics.wheelbase must be > 0; got 0."),
        (CAR.replace("0.5", "1.6"), "dynamics.max_steering_angle must be > 0 and < 1.571 rad, a"
         " right angle; got 1.6."),
        ("max_acceleration: -1", "max_acceleration must be > 0; got -1."),
        ("max_deceleration: 0", "max_deceleration must be > 0; got 0."),
        ("dynamics: {type: unicycle, wheelbase: 1}", "dynamics.wheelbase is not a known key. Known"
         " keys: reverse, type."),
        ("dynamics: {wheelbase: 1}", "dynamics must have the key `type`; got a mapping"
         " (wheelbase)."),
    ],
)  # fmt: skip
def test_one_sentence_for_a_mistake(key, sentence):
    with pytest.raises(ScenarioError) as caught:
        with_keys(key)
    assert str(caught.value) == f"f:6: teams[0].{sentence}"


def test_keys_that_contradict_each_other_are_refused():
    with pytest.raises(ScenarioError, match=r"^f:7: teams\[0\].max_speed must be ≤ dynamics.max_w"):
        with_keys(WHEELS.replace("speed: 1", "speed: 0.5"))
    with pytest.raises(ScenarioError, match=r"^f:7: .*does not apply to ackermann.*steering_rate"):
        with_keys(CAR, "max_turn_acceleration: 3")
