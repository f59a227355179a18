"""What a suite file may say."""

import pytest

from benchnav.config.yaml_reader import read_yaml_text, validate
from benchnav.errors import ScenarioError, UsageError
from benchnav.runner.plan.suite_file import SuiteFile, parse_seeds, suite_names, suite_path

GOOD = """
name: mine
scenarios: [leaders/dynamic]
navigators: [orca, {type: orca, label: patient, horizon: 5.0}]
"""


def read(text):
    return validate(SuiteFile, read_yaml_text(text, "mine.yaml"))


def test_defaults_are_the_test_split_and_twenty_seeds_of_the_known_track():
    suite = read(GOOD)
    assert (suite.split, suite.seeds, suite.tracks, suite.version) == ("test", 20, ("known",), 1)


@pytest.mark.parametrize(
    ("text", "seeds"),
    [
        ("3", range(3)),
        ("5:8", range(5, 8)),
        ("0:1", range(1)),
        ("999999999999998:999999999999999", range(10**15 - 2, 10**15 - 1)),
    ],
)
def test_seeds_are_a_number_or_a_range(text, seeds):
    assert parse_seeds(text) == seeds


@pytest.mark.parametrize(
    "text",
    [
        "",
        "0",
        "-1",
        "3:3",
        "5:2",
        "a:b",
        "1:2:3",
        "1.5",
        "²",
        "9" * 30,
        "999999999999999:1000000000000000",
    ],
)
def test_other_seeds_are_refused_with_the_rule(text):
    with pytest.raises(ValueError, match=r"must be N .* or A:B"):
        parse_seeds(text)


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        ("scenarios: []", "mine.yaml:3: scenarios must have at least 1"),
        ("seeds: 0", "seeds must be N"),
        ("seeds: 1:5000000", "seeds must be N"),
        ("split: tset", "Did you mean 'test'"),
        ("trakcs: [known]", "trakcs is not a known key. Did you mean 'tracks'"),
        ("tracks: [knwon]", "Did you mean 'known'"),
        ("name: Big Name", "name must match"),
        ("navigators: [3]", "navigators"),
        ("version: 0", "version must be ≥ 1"),
    ],
)
def test_mistakes_are_refused_where_they_stand(line, complaint):
    key = line.partition(":")[0]
    lines = [each for each in GOOD.splitlines() if not each.startswith(f"{key}:")]
    lines.insert(2, line)
    with pytest.raises(ScenarioError) as refused:
        read("\n".join(lines))
    assert complaint in str(refused.value)
    assert "mine.yaml:3" in str(refused.value)


def test_shipped_suites_are_found_by_name_and_the_nearest_is_suggested():
    assert "quick" in suite_names()
    assert suite_path("quick").is_file()
    with pytest.raises(UsageError, match="Did you mean 'quick'"):
        suite_path("quikc")
