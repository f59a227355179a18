"""Numbers that a scenario leaves open, and what whoever names it may say of them."""

import jsonschema
import pytest

from benchnav.config.yaml_reader import read_yaml_text
from benchnav.errors import ScenarioError, UsageError
from benchnav.runner.plan.suite import load_suite
from benchnav.scenario.catalogue import find
from benchnav.scenario.load import json_schema, load_scenario, scenario_from_text
from benchnav.scenario.parameters import joined_parameters, split_parameters
from tests.scenario.files import SMALL

OPEN = (
    SMALL.replace("count: 2", "count: {parameter: walkers}").replace(
        "at: [5, 5]", "at: [5, {parameter: height}]"
    )
    + """\
parameters:
  walkers: {default: 2, low: 1, high: 40}
  height: {default: 5, low: 2.5, high: 7.5, description: of the box}
"""
)


def _file(tmp_path, text=OPEN):
    path = tmp_path / "s.yaml"
    path.write_text(text)
    return path


def test_defaults_are_the_same_scenario_as_one_without_parameters():
    plain, left_open = scenario_from_text(SMALL, "a"), scenario_from_text(OPEN, "a")
    assert left_open.hash == plain.hash
    assert left_open.identity == plain.identity == "tests/small@1"


def test_what_is_chosen_stands_in_the_scenario_its_name_and_its_hash(tmp_path):
    path = _file(tmp_path)
    found = find(f"{path}:walkers=7,height=2.5")
    assert found.teams[0].count == 7
    assert found.walls[0].at == (5.0, 2.5)
    assert found.identity == "tests/small@1:height=2.5,walkers=7"
    plain = scenario_from_text(SMALL.replace("count: 2", "count: 7"), "a")
    assert load_scenario(path, {"walkers": 7.0}).hash == plain.hash
    assert find(f"{path}:walkers=2").identity == "tests/small@1"


def test_names_that_ship_and_versions_take_parameters():
    assert find("groups/diagonal:followers=3").teams[1].count == 3
    assert find("groups/diagonal@1:followers=3").identity == "groups/diagonal@1:followers=3"


@pytest.mark.parametrize(
    ("said", "message"),
    [
        ("walker=3", r"has the parameters walkers, height; got 'walker'. Did you mean 'walkers'\?"),
        ("walkers=41", "'walkers' of .*s.yaml must be a whole number from 1 to 40; got 41."),
        ("walkers=2.5", "must be a whole number from 1 to 40; got 2.5."),
        ("height=8", "'height' of .*s.yaml must be a number from 2.5 to 7.5; got 8."),
        ("walkers=many", "must be a whole number from 1 to 40; got many."),
        ("walkers=true", "must be a whole number from 1 to 40; got true."),
        ("walkers=nan", "must be written NAME:key=value,key=value. Got "),
        ("walkers=3,", "must be written NAME:key=value,key=value. Got "),
        ("walkers=", "must be written NAME:key=value,key=value. Got "),
        ("walkers=a b", "must be written NAME:key=value,key=value. Got "),
    ],
)
def test_what_cannot_be_chosen(tmp_path, said, message):
    with pytest.raises(UsageError, match=message):
        find(f"{_file(tmp_path)}:{said}")


def test_a_scenario_without_parameters_takes_none(tmp_path):
    with pytest.raises(UsageError, match="has no parameters; got walkers"):
        find(f"{_file(tmp_path, SMALL)}:walkers=3")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("{parameter: walkers}", "{parameter: walker}",
         "s.yaml:17: teams[0].count.parameter must be one of the scenario's parameters walkers,"
         " height; got 'walker'. Did you mean 'walkers'?"),
        ("{parameter: height}", "5", "s.yaml:31: parameters.height is not used."),
        ("low: 1, high: 40", "low: 3, high: 40",
         "s.yaml:30: parameters.walkers.default must be from 3 to 40; got 2."),
        ("high: 40", "hgih: 40",
         "s.yaml:30: parameters.walkers.hgih is not a known key. Did you mean 'high'?"),
        ("default: 2, low: 1", "default: 1.5, low: 1",
         "s.yaml:17: teams[0].count must be a whole number"),
    ],
)  # fmt: skip
def test_wrong_declarations_name_file_line_and_key(old, new, message):
    assert old in OPEN
    text = OPEN.replace(old, new, 1)
    with pytest.raises(ScenarioError) as caught:
        scenario_from_text(text, "s.yaml")
    assert str(caught.value).startswith(message)


def test_the_schema_knows_parameters():
    schema = jsonschema.Draft202012Validator(json_schema())
    assert schema.is_valid(read_yaml_text(OPEN, "s").data)
    wrong = OPEN.replace("{parameter: walkers}", "{parameter: 3}")
    assert not schema.is_valid(read_yaml_text(wrong, "s").data)


def test_names_fall_apart_and_are_joined_again():
    assert split_parameters("module:Class") == ("module:Class", {})
    assert split_parameters("module:Class:a=1") == ("module:Class", {"a": 1.0})
    assert split_parameters("a/b@2:x=1,y=0.5") == ("a/b@2", {"x": 1.0, "y": 0.5})
    assert joined_parameters({"y": 0.5, "x": 1.0}) == ":x=1,y=0.5"
    assert joined_parameters({}) == ""


def test_suites_name_scenarios_with_parameters(tmp_path):
    _file(tmp_path)
    (tmp_path / "suite.yaml").write_text(
        "name: sizes\nscenarios: ['groups/crossing:followers=3', groups/crossing,"
        " 's.yaml:walkers=5', s.yaml]\nnavigators: [straight-line]\n"
    )
    suite = load_suite(str(tmp_path / "suite.yaml"))
    assert [scenario.identity for scenario in suite.scenarios] == [
        "groups/crossing@1:followers=3",
        "groups/crossing@1",
        "tests/small@1:walkers=5",
        "tests/small@1",
    ]
    assert len({job.key for job in suite.jobs()}) == 4


TYPED = SMALL.replace("- name: walkers", "- name: walkers\n    dynamics: {parameter: drive}") + (
    "rules: {contact: {parameter: contact}}\n"
    "sensing: {occlusion: {parameter: hidden}}\n"
    "parameters:\n"
    "  drive: {default: unicycle, choices: [unicycle, holonomic]}\n"
    "  contact: {default: slide}\n"
    "  hidden: {default: true}\n"
)


def test_a_parameter_may_be_text_or_true_or_false(tmp_path):
    path = _file(tmp_path, TYPED)
    default = find(str(path))
    assert default.identity == "tests/small@1"
    assert (default.teams[0].dynamics.type, default.sensing.occlusion) == ("unicycle", True)
    found = find(f"{path}:drive=holonomic,hidden=false,contact=stop")
    assert found.identity == "tests/small@1:contact=stop,drive=holonomic,hidden=false"
    assert (found.teams[0].dynamics.type, found.sensing.occlusion) == ("holonomic", False)
    assert found.rules.contact == "stop"
    again = found.placed_in(tmp_path, split_parameters(found.identity)[1])
    assert again.identity == found.identity  # as verify rebuilds it


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ("drive=unicicle", "'drive' of .*s.yaml must be one of unicycle, holonomic; got unicicle."
         " Did you mean 'unicycle'?"),
        ("drive=3", "must be one of unicycle, holonomic; got 3."),
        ("hidden=no", "'hidden' of .*s.yaml must be true or false; got no."),
        ("contact=true", "'contact' of .*s.yaml must be text; got true."),
        ("contact=bounce", "s.yaml:30: rules.contact must be 'slide', 'stop' or 'end'; got"
         " 'bounce'."),
    ],
)  # fmt: skip
def test_wrong_texts(tmp_path, given, message):
    with pytest.raises((UsageError, ScenarioError), match=message):
        find(f"{_file(tmp_path, TYPED)}:{given}")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("{default: true}", "{default: true, low: 0}",
         "s.yaml:35: parameters.hidden.low must be left out: the default is not a number."),
        ("{default: slide}", "{default: 1}",
         "s.yaml:34: parameters.contact.low must be given for a number."),
        ("choices: [unicycle, holonomic]", "choices: [holonomic]",
         "s.yaml:33: parameters.drive.default must be one of holonomic; got unicycle."),
        ("{default: true}", "{default: true, choices: [yes]}",
         "s.yaml:35: parameters.hidden.choices must be left out: the default is not text."),
        ("{default: slide}", "{default: [slide]}", "s.yaml:34: parameters.contact.default must be"
         " a number, or true or false, or text; got a list of 1."),
    ],
)  # fmt: skip
def test_wrong_declarations_of_texts(old, new, message):
    with pytest.raises(ScenarioError) as caught:
        scenario_from_text(TYPED.replace(old, new, 1), "s.yaml")
    assert str(caught.value) == message
