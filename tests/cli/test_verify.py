"""From a run to a pack, to somebody who verifies it, to a leaderboard that marks it."""

import json
import shutil

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from benchnav.store.parts.part import RESULTS_FILE
from benchnav.store.runs import receipt
from tests.runner.verify.forge import Forger


def forge(run):
    forger = Forger(run)
    (stem,) = forger.stems()
    table = pq.read_table(stem + RESULTS_FILE)
    names = table["metric"].to_pylist()
    values = table["value"].to_pylist()
    values[names.index("success")] = 0.75
    at = table.column_names.index("value")
    pq.write_table(table.set_column(at, "value", pa.array(values)), stem + RESULTS_FILE)
    forger.seal(stem)


def test_a_run_is_verified_packed_and_verified_elsewhere(call, runs, tmp_path):
    code, stdout, stderr = call("verify", runs[0], "--workers", 0)
    assert code == 0
    assert f"{runs[0]}: verified, in" in stdout
    assert "2 episodes and 0 rehearsals" in stdout
    assert "by the slow reference simulator" in stdout
    assert "timings, which cannot be verified" in stdout
    assert "2 of 2 episodes" in stderr
    code, stdout, _ = call("pack", runs[0], "--out", tmp_path / "one.bnrun")
    assert (code, stdout) == (0, f"{tmp_path / 'one.bnrun'}\n")
    shutil.rmtree(runs[0])
    code, stdout, stderr = call("verify", tmp_path / "one.bnrun", "--workers", 0, "--quiet")
    assert (code, stderr) == (0, "")
    assert f"{tmp_path / 'one.bnrun'}: verified" in stdout


def test_what_was_changed_is_named_for_people_and_for_machines(call, runs):
    forge(runs[0])
    code, stdout, _ = call("verify", runs[0], "--workers", 0, "--twin", 0)
    assert code == 1
    assert f"{runs[0]}: NOT verified: 1 finding" in stdout
    assert "metric  tiny/open@1, known, straight-line, seed " in stdout
    assert "has value 0.75, not " in stdout
    code, stdout, _ = call("verify", runs[0], "--workers", 0, "--json", "--quiet")
    said = json.loads(stdout)
    assert (code, said["verified"], len(said["findings"])) == (1, False, 1)
    assert said["findings"][0]["kind"] == "metric"
    assert said["checked"]["episodes"] == 2


def test_workers_find_the_same(call, runs):
    forge(runs[0])
    texts = []
    for workers in (0, 2):
        code, stdout, stderr = call("verify", runs[0], "--workers", workers, "--json", "--quiet")
        assert (code, stderr) == (1, "")
        said = json.loads(stdout)
        texts.append({key: said[key] for key in ("findings", "checked", "not_checked")})
    assert texts[0] == texts[1]


def test_the_leaderboard_marks_what_was_verified_here(call, runs, tmp_path):
    packs = []
    for run in runs:
        packs.append(tmp_path / f"{run.name}.bnrun")
        call("pack", run, "--out", packs[-1])
    table = call("leaderboard", *packs)[1]
    assert "straight-line" in table
    assert "random-walk" in table
    assert "verified" not in table
    call("verify", packs[0], "--workers", 0, "--twin", 0)
    rows = json.loads(call("leaderboard", *packs, "--format", "json")[1])
    for row in rows:
        timing = row["metric"].startswith(("decision_time", "latency", "planning", "peak", "over"))
        assert row["verified"] == (row["navigator"] == "straight-line" and not timing), row
    table = call("leaderboard", runs[0], packs[1])[1]  # a folder is what its pack is
    assert table.count("| yes ") == 1
    assert table.count("| no ") == 1
    for format in ("html", "latex", "csv"):
        assert "verified" in call("leaderboard", *packs, "--format", format)[1]


def test_verifying_on_the_way(call, runs, tmp_path):
    forge(runs[1])
    code, table, stderr = call("leaderboard", *runs, "--verify")
    assert code == 0
    assert f"{runs[1]} is NOT verified: 1 finding " in stderr
    assert table.count("| yes ") == 1
    again = call("leaderboard", *runs, "--verify")
    assert again[1] == table
    assert f"verifying {runs[0]}" not in again[2]
    assert f"verifying {runs[1]}" in again[2]


def test_a_run_cannot_vouch_for_itself(call, runs, tmp_path):
    """A receipt lies on this machine, for exactly this content, this code and these metrics."""
    call("verify", runs[0], "--workers", 0, "--twin", 0)
    (kept,) = receipt.receipts_folder().iterdir()
    assert "yes" in call("leaderboard", *runs)[1]
    said = json.loads(kept.read_text())
    for change in ({"code": "benchnav 0"}, {"unknown": ["success"]}, {"content": "0"}):
        kept.write_text(json.dumps(said | change))
        assert "verified" not in call("leaderboard", *runs)[1]
    kept.write_text(json.dumps(said))
    shutil.copytree(receipt.receipts_folder(), runs[1] / "verified")
    assert call("leaderboard", *runs)[1].count("| yes ") == 1
    forge(runs[0])
    assert "verified" not in call("leaderboard", *runs)[1]
    call("verify", runs[0], "--workers", 0, "--twin", 0)
    assert "verified" not in call("leaderboard", *runs)[1]


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (("verify", "gone"), "must be a run folder"),
        (("pack", "gone"), "must be a run folder"),
        (("leaderboard", "gone.bnrun"), "must be a run folder"),
    ],
)
def test_what_is_no_run_is_refused(call, arguments, complaint):
    code, stdout, stderr = call(*arguments)
    assert (code, stdout) == (2, "")
    assert complaint in stderr


def test_who_asks_wrongly_is_corrected(call, runs, tmp_path):
    code, _, stderr = call("pack", runs[0], "--out", tmp_path / "x.zip")
    assert (code, "must end in .bnrun" in stderr) == (2, True)
    code, _, stderr = call("verify", runs[0], "--twin", "-1")
    assert (code, "--twin" in stderr) == (2, True)
