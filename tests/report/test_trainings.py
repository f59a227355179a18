"""The report of a run with an entry of several trainings: one page, one row, each failure."""

import pytest

import benchnav
from benchnav.errors import MissingExtraError
from benchnav.report.shared_files import require_libraries

LABELS = ("net (training 1 of 2)", "net (training 2 of 2)")


def test_an_entry_has_one_page_and_each_training_its_failures(tmp_path):
    navigators = [
        {"type": "orca", "label": LABELS[0]},
        {"type": "orca", "label": LABELS[1], "time_horizon": 3},
        "straight-line",
    ]
    run = benchnav.run(
        "quick", scenarios=["trap/u"], navigators=navigators, seeds=2, out=tmp_path / "run",
        quiet=True,
    )  # fmt: skip
    text = str(run.leaderboard()).partition("Caveat")[0]
    assert "(2)" in text
    assert "training 1" not in text
    try:
        require_libraries()
    except MissingExtraError as error:
        pytest.skip(str(error))
    report = run.report(tmp_path / "report", replays=1, quiet=True).parent
    names = sorted(path.name.rpartition("-")[0] for path in (report / "navigators").iterdir())
    assert names == ["net", "straight-line"]
    failures = (report / "failures.html").read_text("utf-8")
    assert all(label in failures for label in LABELS)
    assert "trainings" in (report / "comparison.html").read_text("utf-8")
