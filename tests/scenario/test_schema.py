import jsonschema
import pytest

from benchnav.config.yaml_reader import read_yaml, read_yaml_text
from benchnav.scenario.load import json_schema
from tests.scenario.files import SHIPPED, SMALL


@pytest.fixture(scope="module")
def validator():
    schema = json_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


@pytest.mark.parametrize("path", SHIPPED, ids=lambda p: f"{p.parent.name}/{p.stem}")
def test_shipped_files_fit(validator, path):
    validator.validate(read_yaml(path).data)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("name: tests/small\n", ""),
        ("bounds: [0, 0, 10, 10]", "bounds: [0, 0, 10]"),
        ("radius: 0.2", "radius: big"),
        ("radius: 0.2", "radius: {uniform: [1]}"),
        ("radius: 0.2", "radios: 0.2"),
        ("type: back-and-forth", "type: to-and-fro"),
        ("teams:", "nonsense: 1\nteams:"),
        ("teams:", "rules: {contact: bounce}\nteams:"),
    ],
)
def test_bad_files_do_not(validator, old, new):
    assert not validator.is_valid(read_yaml_text(SMALL.replace(old, new, 1), "s").data)
    assert validator.is_valid(read_yaml_text(SMALL, "s").data)


def test_units_are_in_the_field_texts(validator):
    team = validator.schema["$defs"]["Team"]["properties"]
    assert "[m]" in team["radius"]["description"]
    assert "[m/s]" in team["max_speed"]["description"]
