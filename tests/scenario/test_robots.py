"""Robots by name: what a team takes from one, hashes, and what is wrong with a name or a file."""

import jsonschema
import pytest

import benchnav
from benchnav.config.yaml_packages import robot_files
from benchnav.config.yaml_reader import read_yaml, read_yaml_text
from benchnav.errors import PluginConflictError, ScenarioError, UnknownPluginError, UsageError
from benchnav.scenario import load
from benchnav.scenario.load import scenario_from_text
from benchnav.scenario.robots import registry
from benchnav.scenario.robots.registry import find_robot, register_robot
from benchnav.scenario.robots.robot import ESTIMATE, KEYS, json_schema
from benchnav.scenario.scenario import Scenario

TEXT = """\
name: tests/robots
bounds: [-8, -5, 8, 5]
teams:
  - name: one
    robot: pepper
    start: {type: points, points: [[-4, 0]]}
    goal: {type: points, points: [[4, 0]]}
"""
SHIPPED = sorted(robot_files())
CART = """\
title: A cart
team:
  radius: 0.4
  max_speed: 1.2
sources:
  radius: measured
  max_speed: 'estimate: as fast as its driver'
"""


@pytest.fixture(autouse=True)
def _registered(monkeypatch):
    monkeypatch.setattr(registry, "_registered", {})


def team(text, folder="."):
    return scenario_from_text(text, "f.yaml", folder).teams[0]


def complaint(text, folder="."):
    with pytest.raises(ScenarioError) as caught:
        team(text, folder)
    return str(caught.value)


def test_a_team_takes_the_keys_of_its_robot():
    found = team(TEXT)
    robot = find_robot("pepper")
    assert (found.radius, found.max_speed, found.preferred_speed) == (0.245, 0.55, 0.35)
    assert {key: getattr(found, key) for key in robot.keys if key != "dynamics"} == {
        key: value for key, value in robot.keys.items() if key != "dynamics"
    }


def test_keys_beside_the_robot_win():
    found = team(TEXT.replace("robot: pepper", "robot: pepper\n    max_speed: 0.3\n    radius: 1"))
    assert (found.radius, found.max_speed, found.max_turn_rate) == (1.0, 0.3, 2.0)
    assert found.preferred_speed is None  # the robot's belongs to the robot's largest speed


def test_its_acceleration_limits_can_be_left_out():
    limited = team(TEXT)
    free = team(TEXT.replace("pepper", "{type: pepper, acceleration_limits: false}"))
    assert (limited.max_acceleration, limited.max_turn_acceleration) == (0.55, 3.0)
    assert (free.max_acceleration, free.max_turn_acceleration) == (None, None)
    assert free.max_speed == limited.max_speed


def test_a_scenario_hashes_the_numbers_and_not_the_name():
    plain = TEXT.replace(
        "robot: pepper",
        "\n    ".join(f"{key}: {value}" for key, value in find_robot("pepper").keys.items()),
    )
    assert scenario_from_text(TEXT, "f").hash == scenario_from_text(plain, "f").hash


def test_two_versions_of_a_robot_hash_differently(tmp_path):
    file = TEXT.replace("pepper", "cart.yaml")
    hashes = set()
    for speed in ("1.2", "1.3"):
        (tmp_path / "cart.yaml").write_text(CART.replace("1.2", speed))
        hashes.add(scenario_from_text(file, "f", tmp_path).hash)
    assert len(hashes) == 2


def test_a_stored_scenario_needs_no_robot(tmp_path):
    (tmp_path / "cart.yaml").write_text(CART)
    scenario = scenario_from_text(TEXT.replace("pepper", "cart.yaml"), "f", tmp_path)
    stored = scenario.model_dump(mode="json")
    (tmp_path / "cart.yaml").unlink()
    again = Scenario.model_validate(stored)
    assert again.hash == scenario.hash
    assert again.teams[0].robot.type == "cart.yaml"  # where its numbers come from
    assert list(scenario.files()) == []


def test_a_team_without_a_robot_stores_no_key_for_it():
    text = TEXT.replace("robot: pepper", "radius: 0.2\n    max_speed: 1")
    assert "robot" not in scenario_from_text(text, "f").model_dump(mode="json")["teams"][0]


def test_a_robot_is_registered_in_a_process():
    benchnav.register_robot("cart", "A cart", radius=0.4, max_speed=1.2, max_acceleration=0.8)
    found = team(TEXT.replace("pepper", "cart"))
    assert (found.radius, found.max_acceleration) == (0.4, 0.8)
    assert benchnav.available("robots")["cart"] == "A cart"
    assert "registered in this process" in benchnav.show("cart").text
    register_robot("cart", radius=0.5, max_speed=1.2)
    assert team(TEXT.replace("pepper", "cart")).radius == 0.5


@pytest.mark.parametrize(
    ("name", "keys", "error", "message"),
    [
        ("Cart 1", {}, UsageError, "must be made of small letters, digits and hyphens. Got"
         " 'Cart 1' instead."),
        ("pepper", {"radius": 1}, PluginConflictError, "'pepper' is claimed more than once: "),
        ("cart", {"radius": 0, "max_speed": 1}, ScenarioError, "robot 'cart':3: team.radius must"
         " be > 0; got 0."),
        ("cart", {"radius": 1}, ScenarioError, "team.max_speed must be given."),
        ("cart", {"radius": 1, "maxspeed": 1}, ScenarioError, "team.maxspeed is not a key of a"
         " robot. Did you mean 'max_speed'?"),
        ("cart", {}, ScenarioError, "team must have at least 1 entries"),
    ],
)  # fmt: skip
def test_what_cannot_be_registered(name, keys, error, message):
    with pytest.raises(error) as caught:
        register_robot(name, **keys)
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("written", "message"),
    [
        ("peper", "f.yaml:5: teams[0].robot must be the name of a robot, or a file that ends in"
         " .yaml; got 'peper'. Did you mean 'pepper'? 'benchnav list robots' shows all robots."),
        ("{type: peper}", "f.yaml:5: teams[0].robot must be the name of a robot, or a file that"
         " ends in .yaml; got 'peper'. Did you mean 'pepper'? 'benchnav list robots' shows all"
         " robots."),
        ("5", "f.yaml:5: teams[0].robot must be the name of a robot, or a mapping with its `type`;"
         " got 5."),
        ("[pepper]", "f.yaml:5: teams[0].robot must be the name of a robot, or a mapping with its"
         " `type`; got ['pepper']."),
        ("{type: pepper, limits: false}", "f.yaml:5: teams[0].robot.limits is not a known key."
         " Known keys: acceleration_limits, type."),
        ("{type: pepper, acceleration_limits: 0}", "f.yaml:5:"
         " teams[0].robot.acceleration_limits must be true or false; got 0."),
        ("{acceleration_limits: false}", "f.yaml:5: teams[0].robot.type must be given."),
        ("pepper\n    preferred_speed: 0.6", "f.yaml:6: teams[0].preferred_speed must be ≤"
         " max_speed (0.55); got 0.6."),
    ],
)  # fmt: skip
def test_a_wrong_robot_draws_one_complaint(written, message):
    assert complaint(TEXT.replace("pepper", written)) == message


def test_a_wrong_file_is_reported_with_its_line(tmp_path):
    text = TEXT.replace("pepper", "cart.yaml")
    assert complaint(text, tmp_path) == (
        "f.yaml:5: teams[0].robot must name a robot's file, relative to the scenario's own;"
        f" {tmp_path / 'cart.yaml'} is not a file."
    )
    (tmp_path / "cart.yaml").write_text(CART.replace("max_speed: 1.2", "max_speed: fast"))
    assert "cart.yaml:4: team.max_speed must be a number" in complaint(text, tmp_path)
    (tmp_path / "cart.yaml").write_text(CART.replace("  radius: measured", "  radios: measured"))
    assert "cart.yaml:6: sources.radios must be a key of `team`. Did you mean 'radius'?" in (
        complaint(text, tmp_path)
    )


def test_null_is_no_robot():
    assert (
        complaint(TEXT.replace("pepper", "null")) == "f.yaml:4: teams[0].max_speed must be given."
    )


def test_an_unknown_name_in_python():
    with pytest.raises(UnknownPluginError, match="There is no robot 'peper'"):
        find_robot("peper")


@pytest.mark.parametrize("name", SHIPPED)
def test_every_number_of_a_robot_that_ships_has_a_source(name):
    robot = find_robot(name)
    assert robot.sources.keys() == robot.keys.keys()
    published = [s for s in robot.sources.values() if not s.startswith(ESTIMATE)]
    assert len(published) >= len(robot.keys) / 2
    assert list(robot.keys) == [key for key in KEYS if key in robot.keys]  # in one order
    assert team(TEXT.replace("pepper", name)).robot.type == name


def test_the_schemas_know_robots():
    scenario = jsonschema.Draft202012Validator(load.json_schema())
    assert scenario.is_valid(read_yaml_text(TEXT, "f").data)
    mapping = TEXT.replace("pepper", "{type: {parameter: r}, acceleration_limits: {parameter: a}}")
    assert scenario.is_valid(read_yaml_text(mapping, "f").data)
    assert not scenario.is_valid(read_yaml_text(TEXT.replace("    robot: pepper\n", ""), "f").data)
    offered = benchnav.schema("scenario")["$defs"]["Team"]["properties"]["robot"]["anyOf"][0]
    assert set(SHIPPED) <= set(offered["enum"])  # an editor completes them
    robot = jsonschema.Draft202012Validator(json_schema())
    for name, (file,) in robot_files().items():
        assert robot.is_valid(read_yaml(file.path).data), name
    assert not robot.is_valid({"title": "x", "team": {"start": 1}})
