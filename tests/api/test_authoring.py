"""`benchnav.validate`, `schema`, `import_map` and `new_navigator`."""

import pytest
import yaml
from jsonschema import Draft202012Validator

import benchnav
from benchnav.errors import ScenarioError, UnsolvableError, UsageError

MAP = "type octile\nheight 4\nwidth 6\nmap\n......\n..@@..\n......\n......\n"


def test_a_valid_scenario_has_no_problems(scenario_file):
    for content in (scenario_file, str(scenario_file), yaml.safe_load(scenario_file.read_text())):
        found = benchnav.validate(content)
        assert found
        assert found.problems == []
        assert "is a scenario, tiny/open@1, hash " in repr(found)
        assert "its first test world has 2 agents" in found.facts
    assert "world" not in benchnav.validate(scenario_file, draw=False).facts


def test_a_suite_is_checked_as_run_takes_it(suite):
    found = benchnav.validate(suite)
    assert found.valid
    assert repr(found) == "It is a suite, tiny@1: 2 cells, 0 of them n/a, × 2 seeds"
    found = benchnav.validate({**suite, "navigators": ["orac"]})
    assert not found
    assert "Did you mean 'orca'" in found.problems[0]


def test_each_problem_is_a_line(tmp_path):
    path = tmp_path / "wrong.yaml"
    path.write_text("name: a/b\nbounds: [0, 0, 1, 1]\nteams: []\nwals: []\n")
    first, second = benchnav.validate(path).problems
    assert first.startswith(f"{path}:3: teams must have at least 1 entries")
    assert second.startswith(f"{path}:4: wals is not a known key.")
    found = benchnav.validate(tmp_path / "gone.yaml")
    assert isinstance(found.error, ScenarioError)
    assert "cannot be read" in found._repr_html_()


def test_worlds_that_cannot_be_drawn_are_a_problem(scenario_file):
    content = yaml.safe_load(scenario_file.read_text())
    del content["parameters"]
    content["teams"][0].update(radius=1.4, count=9)
    found = benchnav.validate(content)
    assert isinstance(found.error, UnsolvableError)
    assert found.facts.startswith("It is a scenario")
    assert benchnav.validate(content, draw=False)


@pytest.mark.parametrize("kind", ["scenario", "suite"])
def test_schemas_are_plain_data(kind):
    Draft202012Validator.check_schema(benchnav.schema(kind))


def test_another_schema_is_refused():
    with pytest.raises(UsageError, match="Did you mean 'scenario'"):
        benchnav.schema("scenarios")


def test_a_map_is_imported_by_its_suffix(tmp_path, capfd):
    (tmp_path / "small.map").write_text(MAP)
    out = tmp_path / "made" / "small.yaml"
    files = benchnav.import_map(tmp_path / "small.map", out, agents=2, quiet=True)
    assert files == [out, out.parent / "small.map"]
    assert capfd.readouterr() == ("", "")
    assert benchnav.load_scenario(out).title
    with pytest.raises(UsageError, match="must not exist yet"):
        benchnav.import_map(tmp_path / "small.map", out, agents=2)
    assert benchnav.import_map(tmp_path / "small.map", out, agents=2, force=True) == files


@pytest.mark.parametrize(
    ("map", "options", "text"),
    [
        ("a.map", {"unknown_is_free": True}, "unknown_is_free does not belong to .* movingai"),
        ("a.yaml", {"cell": 2}, "cell does not belong to the format ros-map. Got 2"),
        ("a.pgm", {}, "The format must be given"),
        ("a.pgm", {"format": "ros"}, "Did you mean 'ros-map'"),
    ],
)
def test_options_of_another_format_are_refused(map, options, text):
    with pytest.raises(UsageError, match=text):
        benchnav.import_map(map, "out.yaml", **options)


def test_a_new_navigator_is_a_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    folder = benchnav.new_navigator("my-bot")
    assert str(folder) == "my-bot"
    assert (folder / "src" / "my_bot.py").is_file()
    with pytest.raises(UsageError, match="must be missing or an empty folder"):
        benchnav.new_navigator("my-bot")
    with pytest.raises(UsageError, match=r"must be free.*'my-orca' is free"):
        benchnav.new_navigator("orca", tmp_path / "x")
