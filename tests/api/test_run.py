"""`benchnav.run`, and what a run answers."""

import csv
import io
import json

import pandas as pd
import pytest

import benchnav
from benchnav.cli.main import status
from benchnav.errors import UsageError
from benchnav.navigation.navigator import AgentNavigator


def command(capsys, *arguments):
    assert status([str(argument) for argument in arguments]) == 0
    return capsys.readouterr().out


def test_a_run_tells_what_it_holds(run, suite):
    assert run.navigators == ("orca", "straight-line")
    assert run.scenarios == ("tiny/open@1",)
    assert run.tracks == ("known", "unknown")
    assert run.seeds == range(2)
    text = "tiny@1, 1 scenario × 2 tracks × 2 navigators × 2 seeds"
    assert repr(run) == f"Run({str(run.path)!r}: {text})"
    assert "4 of 4" in run._repr_html_()  # neither uses a map: one episode counts in both tracks


@pytest.mark.parametrize("format", ["markdown", "csv", "latex", "html", "json"])
def test_a_leaderboard_has_the_text_of_the_command(run, format, capsys, tmp_path):
    file = tmp_path / "table"
    text = getattr(run.leaderboard(), f"to_{format}")(file)
    assert text == file.read_text(encoding="utf-8")
    assert text == command(capsys, "leaderboard", run.path, "--format", format)


def test_a_leaderboard_is_a_data_frame_with_the_columns_of_the_csv(run):
    board = run.leaderboard(metrics="success")
    frame, rows = board.to_pandas(), list(csv.DictReader(io.StringIO(board.to_csv())))
    assert list(frame.columns) == list(rows[0])
    assert len(frame) == len(rows) > 0
    assert set(frame.metric) == {"success"}
    assert len(run.leaderboard().to_pandas().metric.unique()) > 20


def test_a_leaderboard_shows_itself(run, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    board = run.leaderboard()
    assert "straight-line" in repr(board)
    assert max(map(len, repr(board).splitlines())) <= 80
    html = board._repr_html_()
    assert html.startswith("<h2>")
    assert "<html" not in html
    assert board.navigators == ("orca", "straight-line")
    assert "path_length" in board.metrics


def test_unknown_metrics_and_columns_are_refused_at_once(run):
    with pytest.raises(UsageError, match="Did you mean 'success'"):
        run.leaderboard(metrics=["sucess"])
    with pytest.raises(UsageError, match="Columns name their metrics"):
        run.leaderboard(metrics="spl", columns=["spl"])
    assert "success" not in run.leaderboard(columns=["rank", "spl"]).to_markdown().split("\n\n")[1]


def test_a_comparison_has_the_text_of_the_command(run, capsys):
    found = run.compare("orca", "straight-line", metrics="all")
    arguments = ("compare", run.path, "orca", "straight-line", "--metric", "all")
    for format in ("markdown", "csv", "json"):
        text = command(capsys, *arguments, "--format", format)
        assert getattr(found, f"to_{format}")() == text
    assert len(found.to_pandas()) == len(json.loads(found.to_json())) > 0
    assert "orca against straight-line" in repr(found)
    assert "<table>" in found._repr_html_()


def test_a_curve_has_the_text_of_the_command(run, capsys):
    text = command(capsys, "leaderboard", run.path, "--curve", "horizon", "--format", "csv")
    curve = run.curve("horizon")
    assert curve.to_csv() == text
    assert isinstance(curve.to_pandas(), pd.DataFrame)


def test_verifying_says_what_was_found_and_marks_the_run(run, monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    found = run.verify(twin=0, workers=0, quiet=True)
    assert found
    assert found.verified
    assert found.findings == ()
    assert repr(found).startswith(f"Verification({run.path}: verified, in ")
    assert json.loads(found.to_json())["verified"] is True


def test_episodes_are_chosen_by_name_and_read_when_used(run):
    every = run.episodes()
    assert len(every) == len(list(every)) == 8
    some = run.episodes(navigator="orca", scenario="tiny/open", track="known")
    assert [e.seed for e in some] == [0, 1]
    assert {e.track for e in some} == {"known"}
    assert some[1].seed == 1
    assert [e.seed for e in some[1:]] == [1]
    assert repr(some) == "Episodes(2: 1 navigator, 1 scenario)"
    assert "<td>orca</td>" in some._repr_html_()
    frame = some.to_pandas()
    assert list(frame.columns[:5]) == ["navigator", "scenario", "track", "perception", "seed"]
    assert set(frame.seed) == {0, 1}
    for wrong, near in (
        ({"navigator": "orka"}, "Did you mean 'orca'"),
        ({"track": "unknwn"}, "Did you mean 'unknown'"),
        ({"scenario": "tiny/opn"}, "Did you mean 'tiny/open'"),
    ):
        with pytest.raises(UsageError, match=near):
            run.episodes(**wrong)


def test_a_run_is_packed_and_opened_again(run, tmp_path):
    pack = run.pack(tmp_path / "run.bnrun", quiet=True)
    with benchnav.open_run(pack) as opened:
        assert len(opened.episodes()) == 8
        folder = opened.folder.path
        assert opened.leaderboard().to_csv() == run.leaderboard().to_csv()
    assert not folder.exists()
    assert [e.seed for e in benchnav.open_run(pack).episodes(navigator="orca")] == [0, 1, 0, 1]


def test_shards_are_merged(suite, tmp_path):
    parts = [
        benchnav.run(suite, navigators="straight-line", out=tmp_path / f"{i}", shard=f"{i}/2",
                     salt="5a" * 16, workers=0, quiet=True)
        for i in (1, 2)
    ]  # fmt: skip
    merged = benchnav.merge(parts, tmp_path / "both", quiet=True)
    assert len(merged.episodes()) == 4


def test_runs_are_joined_in_one_table(run, suite, tmp_path):
    other = benchnav.run(
        suite, navigators="random-walk", out=tmp_path / "other", workers=0, quiet=True
    )
    board = run.leaderboard(runs=[other])
    assert board.navigators == ("orca", "random-walk", "straight-line")
    assert run.compare("orca", "random-walk", runs=[other.path]).records


def test_a_run_continues_with_more_seeds(suite, tmp_path):
    first = benchnav.run(suite, navigators="orca", seeds=1, out=tmp_path, workers=0, quiet=True)
    again = benchnav.run(
        suite, navigators="orca", seeds=range(3), out=tmp_path, workers=0, quiet=True
    )
    assert (first.seeds, again.seeds) == (range(1), range(3))
    assert again.summary.found == 1  # orca uses no map, so one episode counts in both tracks
    with pytest.raises(UsageError, match="without a step"):
        benchnav.run(suite, seeds=range(0, 4, 2))


def test_a_scenario_is_run_by_itself(scenario_file, tmp_path):
    small = benchnav.load_scenario(scenario_file, size=0.1)
    run = benchnav.run(
        small, navigators="straight-line", seeds=1, out=tmp_path, workers=0, quiet=True
    )
    assert run.scenarios == ("tiny/open@1:size=0.1",)


class Greedy(AgentNavigator):
    """Goes straight to the goal."""

    def act_agent(self, view, briefing):
        return view.goal - view.position


def towards(view, briefing):
    """Go straight to the goal."""
    return view.goal - view.position


def test_classes_instances_and_functions_are_run(suite, tmp_path):
    navigators = {
        "class": Greedy, "instance": Greedy(), "function": towards,
        "batch": lambda seen: seen.goal - seen.position,
        "spec": {"type": "orca", "time_horizon": 1},
    }  # fmt: skip
    run = benchnav.run(
        suite, navigators=navigators, tracks="known", out=tmp_path, workers=0, quiet=True
    )
    assert run.navigators == tuple(navigators)
    assert run.summary.failures == {}
    frame = run.episodes(seed=0).to_pandas()
    same = [frame[frame.navigator == name].x.to_list() for name in ("class", "instance", "batch")]
    assert same[0] == same[1] == same[2]


@pytest.mark.slow
def test_a_class_of_a_module_runs_in_workers_and_a_lambda_in_this_process(suite, tmp_path, capfd):
    run = benchnav.run(
        suite, navigators=["straight-line", lambda seen: seen.goal - seen.position],
        tracks="known", out=tmp_path, workers=1,
    )  # fmt: skip
    assert run.navigators == ("straight-line", "function")
    assert run.summary.in_process == ("function",)
    assert "'function' ran in this process" in capfd.readouterr().err
    assert run.folder.manifest.unguarded == ("function",)
