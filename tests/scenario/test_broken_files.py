"""Thousands of broken files: each accepted or refused with file:line, in under a second."""

import re
import tempfile
import time
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchnav.config.yaml_reader import read_yaml
from benchnav.errors import ScenarioError
from benchnav.scenario.load import load_scenario, scenario_from_text
from tests.scenario.files import SHIPPED, SMALL
from tests.scenario.mutations import mutate, text_of

SOURCES = [read_yaml(path).data for path in SHIPPED]
_LINE = re.compile(r"\S+:\d+: .|… and \d+ more\.")


def check(load):
    begin = time.process_time()
    complaint = complaint_of(load)
    assert time.process_time() - begin < 2.0
    if complaint is not None:
        assert complaint
        assert all(_LINE.match(line) for line in complaint.splitlines()), complaint


def complaint_of(load):
    """The text of the refusal; None where the file is accepted."""
    try:
        load()
    except ScenarioError as error:
        return str(error)
    return None


@settings(max_examples=700, deadline=None)
@given(st.data())
def test_changed_files(data):
    broken = data.draw(st.sampled_from(SOURCES))
    for _ in range(data.draw(st.integers(1, 3))):
        broken = mutate(broken, data.draw)
    check(lambda: scenario_from_text(text_of(broken), "s.yaml"))


@settings(max_examples=500, deadline=None)
@given(
    st.lists(st.tuples(st.integers(0, len(SMALL)), st.integers(0, 9), st.binary(max_size=6)),
             min_size=1, max_size=4)
)  # fmt: skip
def test_changed_bytes(edits):
    raw = SMALL.encode()
    for at, cut, put in edits:
        raw = raw[:at] + put + raw[at + cut :]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "s.yaml"
        path.write_bytes(raw)
        check(lambda: load_scenario(path))


@settings(max_examples=200, deadline=None)
@given(st.binary(max_size=300))
def test_random_bytes(raw):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "s.yaml"
        path.write_bytes(raw)
        check(lambda: load_scenario(path))


@pytest.mark.parametrize(
    "text",
    [
        SMALL + "".join(f"k{i}: 1\n" for i in range(24_000)),
        SMALL + "walls2:\n" + "- {type: box}\n" * 16_000,
        SMALL.replace("points: [[5, 1]]", "points: [" + "[5, 1], " * 16_000 + "]"),
        SMALL.replace("ignores: [walkers]", "ignores: [" + "x, " * 49_000 + "]"),
        SMALL.replace(
            "{type: box, width: 1, depth: 2}",
            "{type: polygon, points: [" + ", ".join(f"[{i}, {i % 2}]" for i in range(1000)) + "]}",
        ),
        SMALL.replace("name: tests/small", "name: " + "a-" * 200_000),
        SMALL.replace("name: tests/small", "name: " + "a" * 1_000_000),
    ],
    ids=range(7),
)
def test_enormous_files(text):
    check(lambda: scenario_from_text(text, "s.yaml"))
