"""What a leaderboard marks as verified, and the caveats that stand beside its numbers."""

import json
import shutil

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from benchnav.runner.execute.progress import Progress
from benchnav.store.parts.part import RESULTS_FILE
from benchnav.store.runs.run_folder import RunFolder
from benchnav.verify.verify import Wanted, verify
from tests.conformance.refit import refit_seal
from tests.runner.verify.forge import Forger


def results(run, change):
    """Let the rows of the results of the one part of ``run`` be other ones."""
    (stem,) = Forger(run).stems()
    table = pq.read_table(stem + RESULTS_FILE)
    rows = [new for row in table.to_pylist() if (new := change(row)) is not None]
    pq.write_table(pa.Table.from_pylist(rows, schema=table.schema), stem + RESULTS_FILE)
    refit_seal(stem)


def marks(call, *runs):
    rows = json.loads(call("leaderboard", *runs, "--format", "json")[1])
    return {row["navigator"] for row in rows if row["verified"]}


def test_rows_under_the_label_of_a_verified_entry_are_refused(call, runs):
    assert call("verify", runs[0], "--workers", 0, "--twin", 0)[0] == 0
    results(runs[1], lambda row: {**row, "navigator": "straight-line", "seed": row["seed"] + 2})
    for arguments in (("leaderboard", *runs), ("compare", *runs, "straight-line", "random-walk"),
                      ("leaderboard", *runs, "--verify")):  # fmt: skip
        code, stdout, stderr = call(*arguments)
        assert (code, stdout) == (1, "")
        assert "results.parquet is damaged" in stderr
        assert "must have navigator 'random-walk' in row 0" in stderr
        assert "Traceback" not in stderr


def test_a_label_with_rows_of_one_unverified_run_is_not_marked(call, runs, made, tmp_path):
    from benchnav.runner.plan.suite import Selection, load_suite
    from benchnav.runner.run import run_suite

    more = load_suite(
        str(made / "suite.yaml"), Selection(navigators=("straight-line",), seeds="2:4")
    )
    run_suite(more, tmp_path / "more", workers=1)
    for run in runs:
        call("verify", run, "--workers", 0, "--twin", 0)
    assert marks(call, *runs) == {"straight-line", "random-walk"}
    assert marks(call, *runs, tmp_path / "more") == {"random-walk"}
    call("verify", tmp_path / "more", "--workers", 0, "--twin", 0)
    assert marks(call, *runs, tmp_path / "more") == {"straight-line", "random-walk"}


def test_what_ran_unguarded_is_named_and_never_marked(call, runs):
    Forger(runs[0]).manifest(lambda said: said.update(unguarded=["straight-line"]))
    for run in runs:
        assert call("verify", run, "--workers", 0, "--twin", 0)[0] == 0
    assert marks(call, *runs) == {"random-walk"}
    table = call("leaderboard", *runs)[1]
    assert "Caveat: straight-line ran unguarded" in table
    assert "random-walk ran unguarded" not in table


def test_what_is_exchanged_while_a_run_is_verified_gets_no_receipt(call, runs):
    honest = {
        path: path.read_bytes() for path in (runs[0] / "parts").rglob("*.*") if path.is_file()
    }

    class Swap(Progress):
        def begin(self, *told):
            results(runs[0], lambda row: {**row, "value": 0.5})

    report = verify(RunFolder.open(runs[0]), Wanted(0), workers=0, progress=Swap())
    assert "changed" in {finding.kind for finding in report.findings}
    assert "verify again when no process writes it" in str(report.findings)
    for path, content in honest.items():
        path.write_bytes(content)
    assert verify(RunFolder.open(runs[0]), Wanted(0), workers=0).clean


def test_a_receipt_is_for_what_was_read_and_not_for_what_lies_there_afterwards(
    call, runs, monkeypatch
):
    """The forged run lies there before and after; the honest one while it is checked."""
    forged = shutil.copytree(runs[0], runs[0].with_name("forged"))
    results(forged, lambda row: {**row, "value": 1.0})
    honest = shutil.copytree(runs[0], runs[0].with_name("honest"))

    def put(source):
        for path in source.rglob("*.*"):
            if path.is_file():
                shutil.copy(path, runs[0] / path.relative_to(source))

    class Swap(Progress):
        def begin(self, *told):
            put(honest)

        def end(self):
            put(forged)

    put(forged)
    monkeypatch.setattr("benchnav.runner.execute.progress.progress", lambda quiet: Swap())
    code, stdout, _ = call("verify", runs[0], "--workers", 0, "--twin", 0)
    assert (code, "NOT verified" in stdout) == (1, True)
    monkeypatch.undo()
    assert "verified" not in call("leaderboard", *runs)[1]


@pytest.mark.parametrize("key", ["name", "version"])
def test_an_easy_world_under_the_name_of_a_hard_one_is_named(call, runs, made, tmp_path, key):
    from benchnav.runner.plan.suite import load_suite
    from benchnav.runner.run import run_suite

    text = (made / "open.yaml").read_text()
    text = text.replace("name: tiny/open", "name: trap/u" + ("\nversion: 9" * (key == "version")))
    (tmp_path / "easy.yaml").write_text(text)
    (tmp_path / "quick.yaml").write_text(
        "name: quick\nscenarios: [easy.yaml]\nseeds: 2\n"
        "navigators: [{type: straight-line, label: orca}]\n"
    )
    easy = tmp_path / "easy"
    run_suite(load_suite(str(tmp_path / "quick.yaml")), easy, workers=1)
    code, verdict, _ = call("verify", easy, "--workers", 0, "--twin", 0)
    shown = [
        call("leaderboard", easy, "--format", f)[1] for f in ("markdown", "html", "json", "csv")
    ]
    latex = call("leaderboard", easy, "--format", "latex")[1]
    assert "u@" in latex.partition("Caveat")[2]
    assert code == 0
    for text in (verdict, *shown):
        said = " ".join(text.replace("&#x27;", "'").split())
        if key == "name":
            assert "trap/u@1 is another scenario than the one of this name that is" in said
        else:
            assert "trap/u@9 cannot be compared" in said
        assert "The label orca stands for the navigator straight-line" in said
        assert "is not run as it is installed here: version 1, not" in said
        assert "1 scenario that it does not have (trap/u" in said or "of its" in said


def test_metrics_that_are_left_out_or_made_up_are_named(call, runs):
    """Also in a run that says it was made by another version."""

    def change(row):
        return None if row["metric"] == "collided" else row

    results(runs[0], change)
    (finding,) = json.loads(call("verify", runs[0], "--workers", 0, "--json")[1])["findings"][:1]
    assert "collided of leaders is missing" in finding["what"] or "collided" in finding["what"]
    Forger(runs[0]).manifest(lambda said: said["versions"].update(benchnav="0.0.1"))
    results(runs[0], lambda row: {**row, "metric": "charm"} if row["metric"] == "spl" else row)
    code, stdout, _ = call("verify", runs[0], "--workers", 0, "--twin", 0)
    assert code == 0
    text = " ".join(stdout.split())
    assert "value of the metric 'charm', which is not installed here" in text
    assert "installed here and not measured in the run: collided, spl" in text
    table = call("leaderboard", *runs)[1]
    assert "Not measured in all episodes of straight-line: collided, spl." in table
    assert "Not installed here, so its definition is unknown: charm." in table
    assert "of random-walk" not in table
