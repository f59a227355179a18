"""Values are flipped all over a run, its checksums made to fit, and every flip is named."""

import dataclasses
import json
import shutil
from collections import Counter
from contextlib import suppress
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

from benchnav.errors import CorruptPartError
from benchnav.metrics.measure import all_metrics
from benchnav.store.parts.episodes import EPISODES, from_table
from benchnav.store.parts.part import EPISODES_FILE, REHEARSALS_FILE, RESULTS_FILE, SEAL
from benchnav.store.parts.results import RESULTS
from benchnav.store.runs import checked_json
from benchnav.store.runs.run_folder import RunFolder
from tests.runner.verify.forge import flipped, numbers_of

# nothing finds a timing that is a little off, nor another traceback; remarks stand in the results
CLAIMED = {
    "decision_seconds", "planning_seconds", "rehearsal_seconds", "batch", "latency_seconds",
    "reproducible", "traceback",
}  # fmt: skip
TIMINGS = {metric.name for metric in all_metrics() if not metric.verifiable}


def test_a_genuine_run_has_no_findings(genuine, findings):
    _, report = findings(genuine)
    assert report.findings == []
    assert report.counts["episodes"] == 12
    assert report.counts["rehearsals"] == 6
    assert report.counts["n/a cells"] == 4
    assert report.counts["values"] > 12 * 20
    assert report.counts["values of timings"] >= 12 * len(TIMINGS)


@pytest.mark.parametrize("cell", ["rotor", "guided"])
@pytest.mark.parametrize("column", EPISODES.names)
def test_every_column_of_episodes(forger, findings, column, cell):
    (stem,) = forger.stems(cell)
    table = pq.read_table(stem + EPISODES_FILE)
    if column not in table.column_names:
        pytest.skip("parts of exact perception have no such column")
    rows = [i for i, value in enumerate(table[column].to_pylist()) if value not in (None, [])]
    if not rows:
        pytest.skip("there is nothing to flip")

    def change(value):
        if column == "memory_bytes":  # a byte of gigabytes is within tolerance
            return 2 * value
        return _with_another_world(value) if column == "world" else flipped(value)

    forger.column(stem, EPISODES_FILE, column, change, rows[-1])
    kinds, report = findings(forger.run)
    assert bool(kinds) == (column not in CLAIMED), report.findings
    assert all(cell in f.where for f in report.findings)


@pytest.mark.parametrize("column", EPISODES.names)
def test_every_column_of_rehearsals(forger, findings, column):
    (stem,) = forger.stems("guided")
    table = pq.read_table(stem + REHEARSALS_FILE)
    if column not in table.column_names or table[column].to_pylist()[1] in (None, []):
        pytest.skip("there is nothing to flip")

    def change(value):
        return _with_another_world(value) if column == "world" else flipped(value)

    forger.column(stem, REHEARSALS_FILE, column, change, 1)
    kinds, report = findings(forger.run)
    claimed = (CLAIMED | {"remarks"}) - {"reproducible", "rehearsal_seconds"}  # are not free there
    assert bool(kinds) == (column not in claimed), report.findings


def _with_another_world(text, share=0.5):
    places = numbers_of(text)
    first, last = places[int(share * len(places))]
    return f"{text[:first]}{json.dumps(flipped(json.loads(text[first:last])))}{text[last:]}"


@pytest.mark.parametrize("share", np.linspace(0.0, 0.999, 8))
def test_numbers_all_over_a_world(forger, findings, share):
    (stem,) = forger.stems("walk")
    forger.column(stem, EPISODES_FILE, "world", lambda text: _with_another_world(text, share))
    assert findings(forger.run)[0] & {"world", "seal"}


ARRAYS = ("position", "heading", "status", "executed", "body_position", "arrival")
EVENTS = ("agent", "partner", "start", "end", "penetration", "closing_speed", "charged")


@pytest.mark.parametrize("name", ARRAYS)
def test_states_whose_digest_was_made_to_fit(forger, findings, name):
    (stem,) = forger.stems("rotor")

    def change(episode):
        array = getattr(episode, name).copy()
        array.flat[-1] = flipped(array.flat[-1].item())
        return dataclasses.replace(episode, **{name: array})

    forger.episode(stem, change)
    kinds, report = findings(forger.run)
    assert kinds & {"state", "command"}
    assert name in " ".join(finding.what for finding in report.findings)


@pytest.mark.parametrize("name", EVENTS)
def test_events_whose_digest_was_made_to_fit(forger, findings, name):
    for stem in forger.stems():
        counts = [len(a) for a in pq.read_table(stem + EPISODES_FILE)["contact_agent"].to_pylist()]
        if max(counts):
            break

    def change(episode):
        array = getattr(episode.contacts, name).copy()
        array[0] = flipped(array[0].item())
        contacts = dataclasses.replace(episode.contacts, **{name: array})
        return dataclasses.replace(episode, contacts=contacts)

    forger.episode(stem, change, row=int(np.argmax(counts)))
    assert "event" in findings(forger.run)[0]


def test_commands_whose_digest_was_made_to_fit(forger, findings):
    (stem,) = forger.stems("walk")

    def change(episode):
        requested = episode.requested.copy()
        requested[0, 0] *= -1.0  # the other way: a tenth less may be beyond the limits as well
        return dataclasses.replace(episode, requested=requested)

    forger.episode(stem, change)
    assert findings(forger.run)[0] & {"state", "command"}


def test_commands_of_who_is_not_active(forger, findings):
    stem, row = next(
        (stem, row)
        for stem in forger.stems()
        for row, episode in enumerate(from_table(pq.read_table(stem + EPISODES_FILE)))
        if (episode.status[:-1] != 0).any()
    )

    def change(episode):
        requested = episode.requested.copy()
        t, i = np.argwhere(episode.status[:-1] != 0)[-1]
        requested[t, i] = 1.0
        return dataclasses.replace(episode, requested=requested)

    forger.episode(stem, change, row=row)
    kinds, report = findings(forger.run)
    assert kinds == {"command"}, report.findings
    assert "must be 0" in report.findings[0].what


@pytest.mark.parametrize("steps", [-1, 1])
def test_an_episode_that_was_cut_or_goes_on(forger, findings, steps):
    (stem,) = forger.stems("walk")

    def change(episode):
        arrays = ("position", "heading", "status", "body_position", "requested", "executed")
        longer = {}
        for name in arrays:
            array = getattr(episode, name)
            longer[name] = array[:-1] if steps < 0 else np.concatenate([array, array[-1:]])
        seconds = np.zeros(len(longer["requested"]))
        timings = dataclasses.replace(episode.timings, decision=seconds)
        return dataclasses.replace(episode, **longer, timings=timings)

    forger.episode(stem, change)
    kinds, _ = findings(forger.run)
    assert kinds & {"state", "command"}


@pytest.mark.parametrize("cell", ["walk", "guided"])
@pytest.mark.parametrize("column", RESULTS.names)
def test_every_column_of_results(forger, findings, column, cell):
    (stem,) = forger.stems(cell)
    rows = pq.read_table(stem + RESULTS_FILE).to_pylist()
    if column not in rows[0]:
        pytest.skip("parts of exact perception have no such column")
    row = next(
        i for i, r in enumerate(rows)
        if r["metric"] not in TIMINGS and r["value"] == r["value"] and abs(r["value"]) > 0.01
    )  # fmt: skip

    def change(value):
        return _off(value) if column in ("value", "rehearsal_seconds") else flipped(value)

    forger.column(stem, RESULTS_FILE, column, change, row)
    assert findings(forger.run)[0] & {"metric", "identity", "seal"}


def test_every_metric(forger, findings):
    (stem,) = forger.stems("walk")
    table = pq.read_table(stem + RESULTS_FILE)
    names = table["metric"].to_pylist()
    for name in set(names):
        forger.column(stem, RESULTS_FILE, "value", _off, names.index(name))
    kinds, report = findings(forger.run)
    assert kinds == {"metric"}
    assert {f.what.split()[0] for f in report.findings} == {m.name for m in all_metrics()}


def _off(value):
    return 0.25 if value != value or abs(value) == np.inf else value + 1e-8 + 1e-8 * abs(value)


def test_values_that_lack_or_stand_twice(forger, findings):
    (stem,) = forger.stems("walk")
    table = pq.read_table(stem + RESULTS_FILE)
    names = Counter(table["metric"].to_pylist())
    for kept, word in (
        (table.slice(1), "missing"),
        (table.take([0, *range(len(table))]), "one row"),
    ):
        pq.write_table(kept, stem + RESULTS_FILE)
        forger.seal(stem)
        kinds, report = findings(forger.run)
        assert kinds <= {"metric", "seal"}
        assert word in report.findings[0].what
    pq.write_table(table, stem + RESULTS_FILE)
    for name in ("collided", "success"):  # in all episodes of a run
        assert name in names
        for each in forger.stems():
            table = pq.read_table(each + RESULTS_FILE)
            other = [value != name for value in table["metric"].to_pylist()]
            pq.write_table(table.filter(other), each + RESULTS_FILE)
            forger.seal(each)
        assert findings(forger.run)[0] == {"metric"}


def test_a_timing_that_is_far_off_or_impossible(forger, findings):
    (stem,) = forger.stems("walk")
    forger.column(stem, EPISODES_FILE, "planning_seconds", lambda value: value + 1.0)
    assert findings(forger.run)[0] == {"metric"}  # which was measured on the other one
    forger.column(stem, EPISODES_FILE, "planning_seconds", lambda value: -1.0)
    assert "timing" in findings(forger.run)[0]


def test_seals(forger, findings):
    (stem,) = forger.stems("walk")
    genuine = Path(stem + SEAL).read_text()
    said = checked_json.load(genuine)
    facts = said[RESULTS_FILE]
    for changed in (
        {**said, RESULTS_FILE: {**facts, "bytes": facts["bytes"] + 1}},
        {**said, RESULTS_FILE: {**facts, "sha256": "0" * 64}},
        {**said, "episodes": 4},
        {k: v for k, v in said.items() if k != RESULTS_FILE},
        {},
    ):
        Path(stem + SEAL).write_text(checked_json.dump(changed))
        assert "seal" in findings(forger.run)[0], changed
    Path(stem + SEAL).write_text(genuine)
    assert findings(forger.run)[0] == set()


def test_parts_that_lack_or_are_too_much(forger, findings):
    (walk,), (rotor,) = forger.stems("walk"), forger.stems("rotor")
    na = next(
        c["key"] for c in json.loads((forger.run / "manifest.json").read_text())["cells"]
        if c["reason"]
    )  # fmt: skip
    folder = walk.rsplit("/", 1)[0]
    shutil.copytree(folder, forger.run / "parts" / "stray")
    shutil.copytree(folder, RunFolder.open(forger.run).cell(na))
    for suffix in (EPISODES_FILE, RESULTS_FILE, SEAL):
        shutil.copy(walk + suffix, walk.replace("000000-000003", "000002-000005") + suffix)
    Path(rotor + SEAL).unlink()
    kinds, report = findings(forger.run)
    assert {"coverage", "identity"} <= kinds
    said = " | ".join(f"{f.where}: {f.what}" for f in report.findings if f.kind == "coverage")
    for text in ("stray: is not a cell", "is n/a", "1 seed stored twice: 2", "2 seeds not of",
                 "rotor: 3 seeds missing: 0, 1, 2"):  # fmt: skip
        assert text in said, said


def _first(said, *path):
    for key in path[:-1]:
        said = said[key]
    return said, path[-1]


@pytest.mark.parametrize(
    "path",
    [
        ("salt",),
        ("suite", "split"),
        ("suite", "seeds", 0),
        ("suite", "seeds", 1),
        ("suite", "tracks", 0),
        ("suite", "scenarios", 0, "scenario"),
        ("suite", "scenarios", 0, "hash"),
        ("suite", "scenarios", 0, "config", "bounds", 0),
        ("suite", "scenarios", 0, "config", "clock", "dt"),
        ("suite", "scenarios", 0, "config", "rules", "goal_tolerance"),
        ("suite", "scenarios", 0, "config", "teams", 0, "max_speed"),
        ("suite", "navigators", 0, "label"),
        ("suite", "navigators", 0, "source"),
        ("suite", "navigators", 0, "config", "type"),
        ("suite", "navigators", 3, "rehearsal"),
        ("suite", "navigators", 3, "leader", "config", "type"),
        ("suite", "navigators", 3, "leader", "source"),
        ("cells", 0, "key"),
        ("cells", 0, "scenario"),
        ("cells", 0, "track"),
        ("cells", 0, "navigator"),
        ("cells", 0, "reason"),
        ("cells", 4, "reason"),
    ],
    ids=lambda path: ".".join(map(str, path)),
)
def test_what_a_manifest_says(forger, findings, path):
    def change(said):
        place, key = _first(said, *path)
        value = place[key]
        place[key] = (
            "ab" * 16 if key == "salt" else -9.0 if key == 0 and value == -4 else (flipped(value))
        )

    forger.manifest(change)
    with suppress(CorruptPartError):  # it is refused where no manifest can say so
        assert findings(forger.run)[0]


def test_what_is_merely_claimed_is_not_found(forger, findings):
    """The documents list it: whoever made the run says so, and nobody can tell."""

    def change(said):
        said["created"], said["platform"] = "2001-01-01T00:00:00+00:00", "Altair"
        said["suite"]["name"] = "another"

    forger.manifest(change)
    assert findings(forger.run)[0] == set()
