"""What pictures show, read off the figures before they are written."""

import sys

import numpy as np
import pytest

from benchnav.errors import MissingExtraError, StoreError
from benchnav.leaderboard.statistics.curve import Setting, parameter_curves
from benchnav.leaderboard.statistics.head_to_head import duel
from benchnav.viewer.curves import draw_curves
from benchnav.viewer.forest import draw_duel
from benchnav.viewer.picture import BLUE, GREY, RED, blank, is_picture, save
from tests.leaderboard.tables import METRICS, scores, table

pytest.importorskip("matplotlib")

ROWS = (
    scores({"a": [1.0] * 20, "b": [0.0] * 20})
    + scores({"a": [0.0] * 20, "b": [1.0] * 20}, "collided")
    + scores({"a": [0.0] * 20, "b": [1.0] * 20}, scenario="x@1")
    + scores({"a": [1.0, 0.0] * 10, "b": [0.0, 1.0] * 10}, track="known")
)


def points_of(axes):
    """(x, y, colour, filled) of every marker."""
    lines = [line for line in axes.lines if line.get_marker() in ("o", "D")]
    return [
        (
            float(line.get_xdata()[0]), float(line.get_ydata()[0]), line.get_color(),
            line.get_markerfacecolor() == line.get_color(),
        )
        for line in lines
    ]  # fmt: skip


def test_a_duel_is_drawn_as_it_is_judged():
    figure = draw_duel(duel(table(ROWS), METRICS, ("success", "collided"), "a", "b"), METRICS)
    success, collided = figure.axes
    labels = [text.get_text() for text in success.get_yticklabels()]
    assert labels == [
        "leaders/static@1, known", "leaders/static@1, unknown", "x@1, unknown",
        "all scenarios, unknown",
    ]  # fmt: skip
    assert points_of(success) == [
        (0.0, 0, GREY, False), (100.0, 1, BLUE, True), (-100.0, 2, RED, True), (0.0, 3, GREY, False)
    ]  # fmt: skip
    assert points_of(collided)[0] == (-100.0, 1, BLUE, True)  # fewer collisions are better
    assert success.get_xlabel().endswith("← B better   A better →")
    assert collided.get_xlabel().endswith("← A better   B better →")
    assert figure.get_suptitle() == "A: a   B: b   (A − B)"


def test_times_of_arrivals_have_a_better_side():
    rows = scores({"a": [9.0, 9.5] * 10, "b": [5.0, 6.0] * 10}, "time_to_goal")
    (axes,) = draw_duel(duel(table(rows), METRICS, ("time_to_goal",), "a", "b"), METRICS).axes
    assert [point[2:] for point in points_of(axes)] == [(RED, True)]
    assert axes.get_xlabel().splitlines()[1:] == [
        "← A better   B better →", "among agents that arrive",
    ]  # fmt: skip


def test_what_rehearsed_is_drawn_hollow_and_said():
    rows = scores({"a": [0.0] * 20}) + scores({"b": [1.0] * 20}, rehearsal=5)
    figure = draw_duel(duel(table(rows), METRICS, ("success",), "a", "b"), METRICS)
    assert points_of(figure.axes[0]) == [(-100.0, 0, GREY, False)]
    assert "not as equals" in figure.get_supxlabel()


def curves(tracks):
    where = {f"s@1:far={x}": Setting("s@1", float(x), "m") for x in (0, 2)}
    rows = []
    for name, setting in where.items():
        for track in tracks:
            values = {"a": [setting.x / 2] * 9, "b": [0.5] * 9}
            rows += scores(values, scenario=name, scenario_hash=name, track=track)
    return parameter_curves(table(rows), METRICS["success"], "far", where)


def test_curves_have_a_column_for_each_track():
    figure = draw_curves(curves(("unknown", "known")))
    known, unknown = figure.axes
    assert known.get_title() == "s@1\ntrack known, 9 worlds"
    assert unknown.get_title() == "s@1\ntrack unknown, 9 worlds"
    first, second = known.lines
    assert (first.get_label(), second.get_label()) == ("a", "b")
    assert first.get_xydata() == pytest.approx(np.array([[0.0, 0.0], [2.0, 1.0]]))
    assert known.get_xlabel() == "far [m]"
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["a", "b"]


def test_a_picture_is_the_same_bytes_again(tmp_path):
    for suffix in ("png", "svg"):
        files = [tmp_path / f"{k}.{suffix}" for k in range(2)]
        for file in files:
            save(draw_curves(curves(("known",))), file)
        assert files[0].read_bytes() == files[1].read_bytes()
    with pytest.raises(StoreError, match="must be writable"):
        save(blank(1, 1), files[0] / "x.png")


def test_the_end_of_a_name_says_whether_it_is_a_picture(tmp_path):
    assert is_picture(tmp_path / "x.PNG")
    assert not is_picture(tmp_path / "x.md")
    assert not is_picture(None)


def test_without_matplotlib_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(MissingExtraError, match=r"benchnav\[view\]"):
        blank(1, 1)
