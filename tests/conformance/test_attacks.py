"""Whatever is changed in a run is found, but for what the documents list."""

import json
from pathlib import Path

import pytest

from benchnav.store.parts.episodes import EPISODES
from benchnav.store.parts.results import RESULTS
from tests.conformance.attacks import attack, by_design, honest_run, is_by_design

DOCUMENT = Path(__file__).parents[2] / "docs" / "verification.md"


def test_the_documents_list_word_for_word_what_is_not_found():
    assert by_design() in DOCUMENT.read_text()


@pytest.mark.long
def test_one_change_of_eleven(tmp_path):
    outcome = attack(honest_run(tmp_path), every=11)
    assert len(outcome.found) > 20
    assert [name for name in outcome.missed if not is_by_design(name)] == []


@pytest.mark.soak
def test_every_column_and_every_key(tmp_path):
    run = honest_run(tmp_path)
    outcome = attack(run)
    report = {
        "tried": outcome.tried, "found": outcome.found, "by design not found": outcome.missed
    }  # fmt: skip
    print(json.dumps(report, indent=1))
    columns = {
        f"{table}.{name}"
        for table, schema in (
            ("episodes", EPISODES),
            ("rehearsals", EPISODES),
            ("results", RESULTS),
        )
        for name in schema.names
        if not name.startswith("contact_") and name != "body_position"  # empty in this run
    }
    assert columns - set(outcome.tried) == set()
    assert [name for name in outcome.missed if not is_by_design(name)] == []
    used = {pattern for name in outcome.missed for pattern in is_by_design(name)}
    listed = {pattern for names in by_design().splitlines() for pattern in names.split("`")[1::2]}
    assert used == listed
