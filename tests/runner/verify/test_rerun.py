"""What only running the navigators again finds, and what it does not touch."""

import dataclasses
import json
import shutil
import sys

import numpy as np
import pyarrow.parquet as pq
import pytest

from benchnav.metrics.measure import all_metrics
from benchnav.runner.execute.measurement import measured
from benchnav.runner.plan.suite import Selection, load_suite
from benchnav.runner.run import run_suite
from benchnav.store.packs.pack import pack
from benchnav.store.parts.episodes import from_table, to_table
from benchnav.store.parts.part import EPISODES_FILE, RESULTS_FILE
from benchnav.store.runs.run_folder import RunFolder
from benchnav.verify.resimulation import resimulate
from tests.runner.verify.forge import Forger


@pytest.fixture
def replaced(forger):
    """Commands of a navigator replaced by others, and everything made to follow from them."""
    (stem,) = forger.stems("walk")
    old = list(from_table(pq.read_table(stem + EPISODES_FILE)))
    gentle = dataclasses.replace(old[0], requested=0.99 * old[0].requested)
    steps = len(gentle.requested)
    ((new, wrong, _),) = resimulate([(gentle.world, gentle)])
    if wrong:  # it would go on: hold still to the horizon
        more = np.zeros((gentle.world.clock.steps - steps, *gentle.requested.shape[1:]))
        longer = dataclasses.replace(gentle, requested=np.concatenate([gentle.requested, more]))
        ((new, wrong, _),) = resimulate([(gentle.world, longer)])
    assert not wrong
    seconds = np.full(len(new.requested), 1e-4)
    new = dataclasses.replace(new, timings=dataclasses.replace(old[0].timings, decision=seconds))
    pq.write_table(to_table([new, *old[1:]]), stem + EPISODES_FILE)
    pq.write_table(measured([new, *old[1:]], all_metrics()), stem + RESULTS_FILE)
    forger.seal(stem)
    return forger.run


def test_a_genuine_run_is_repeated(genuine, findings):
    kinds, report = findings(genuine, rerun=True)
    assert kinds == set()
    assert report.counts["rerun"] == 12
    assert report.counts["rerun n/a"] == 4
    assert report.notes == {}


def test_commands_that_were_replaced_consistently(replaced, findings):
    assert findings(replaced)[0] == set()
    kinds, report = findings(replaced, rerun=True)
    assert kinds == {"rerun"}
    assert len({f.where for f in report.findings}) == 1
    assert report.findings[0].where.startswith("tiny/crossing@1, known, walk, seed ")


def test_a_claim_that_a_clock_decided_is_not_believed(replaced, findings):
    """The installed navigators are asked: otherwise the claim would keep them from being run."""
    forger = Forger(replaced)
    (stem,) = forger.stems("walk")
    for row in range(3):
        forger.column(stem, EPISODES_FILE, "reproducible", lambda _: False, row)
    assert findings(replaced)[0] == set()
    kinds, report = findings(replaced, rerun=True)
    text = " | ".join(finding.what for finding in report.findings)
    assert kinds == {"rerun"}
    assert text.count("reproducible is False, run again True") == 3
    assert text.count("digest is") == 1
    assert report.notes == {}


@pytest.mark.parametrize(
    ("change", "kind"),
    [
        (lambda said: said["suite"]["navigators"][1].update(source="benchnav 9.9"), "note"),
        (lambda said: said.update(salt="ab" * 16), "rerun"),
        (lambda said: said["suite"]["navigators"][0].update(uses_map=False), "rerun"),
        (lambda said: said["cells"][4].update(reason="needs wings"), "manifest"),
    ],
    ids=["source", "salt", "map", "reason"],
)
def test_what_a_manifest_says(forger, findings, change, kind):
    forger.manifest(change)
    kinds, report = findings(forger.run, rerun=True)
    if kind == "note":
        assert any("rotor differs here" in note for note in report.notes)
    else:
        assert kind in kinds


def test_a_cell_that_need_not_be_n_a(forger, findings):
    def change(said):
        said["cells"][1]["reason"] = "needs a map"

    forger.manifest(change)
    key = json.loads((forger.run / "manifest.json").read_text())["cells"][1]["key"]
    shutil.rmtree(RunFolder.open(forger.run).cell(key))
    assert findings(forger.run)[0] == set()  # only the navigator knows what it needs
    kinds, report = findings(forger.run, rerun=True)
    assert kinds == {"rerun"}
    assert "but the navigator reports ''" in report.findings[0].what


def test_nothing_that_a_strangers_pack_names_by_module_is_imported(genuine, findings, tmp_path):
    pack(RunFolder.open(genuine), tmp_path / "theirs.bnrun")
    kinds, report = findings(tmp_path / "theirs.bnrun", rerun=True)
    assert kinds == set()
    assert report.counts["rerun"] == 3  # those of the navigator that is registered
    assert sum(n for note, n in report.notes.items() if "named by its module" in note) >= 9


@pytest.fixture(scope="module")
def apart(scenario, troubled, tmp_path_factory):
    """A run of isolated navigators, and of a program that notes when it is started."""
    folder = tmp_path_factory.mktemp("apart")
    noting = f"open({str(folder / 'starts')!r}, 'a').write('.')"
    host = "from benchnav.isolation.host import main; main()"
    program = {
        "type": "process", "label": "program",
        "command": [sys.executable, "-c", f"{noting}; {host}", "straight-line"],
    }  # fmt: skip
    walk = {"type": "troubled_navigators:Walk", "label": "walk"}
    suite = {
        "name": "apart", "scenarios": [str(scenario.folder / "tiny.yaml")], "tracks": ["known"],
        "navigators": [walk, program, "straight-line"], "seeds": 2,
    }  # fmt: skip
    (folder / "apart.yaml").write_text(json.dumps(suite))
    loaded = load_suite(str(folder / "apart.yaml"), Selection(isolate=True))
    run_suite(loaded, folder / "run", workers=0)
    return folder


def test_isolated_navigators_are_run_again_in_processes_of_their_own(apart, findings):
    kinds, report = findings(apart / "run", rerun=True)
    assert kinds == set()
    assert (report.counts["rerun"], report.notes) == (6, {})


def test_no_program_of_a_strangers_pack_is_started(apart, findings, tmp_path):
    pack(RunFolder.open(apart / "run"), tmp_path / "theirs.bnrun")
    before = (apart / "starts").read_text()
    kinds, report = findings(tmp_path / "theirs.bnrun", rerun=True)
    assert kinds == set()
    assert (apart / "starts").read_text() == before
    assert any("is a program, in an untrusted pack" in note for note in report.notes)
