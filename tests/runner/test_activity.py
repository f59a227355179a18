"""During one long episode, the display shows what its worker does."""

import io
import math
from types import SimpleNamespace

import pytest
from rich.console import Console

from benchnav.runner.execute import progress
from benchnav.runner.execute.activity import activity
from benchnav.runner.execute.call_timer import (
    SIZE,
    CallTimer,
    beat,
    calling,
    note_drawing,
    write_to,
)
from benchnav.runner.execute.progress import Bar, Lines, Progress
from benchnav.runner.plan.suite import Selection, load_suite
from benchnav.runner.run import run_suite


@pytest.fixture
def timer():
    notes = [0.0] * SIZE
    write_to(notes)
    yield CallTimer(notes)
    write_to([0.0] * SIZE)


def task(first=0, stop=1):
    clock = SimpleNamespace(dt=0.2, steps=4000)
    job = SimpleNamespace(
        scenario=SimpleNamespace(name="big/map", clock=clock),
        contestant=SimpleNamespace(label="orca"),
    )
    return SimpleNamespace(job=job, first=first, stop=stop, seeds=range(first, stop))


def test_drawing_deciding_and_measuring_are_shown(timer):
    assert activity(task(), timer, False) == ""
    note_drawing(1)
    assert activity(task(), timer, False) == "drawing the world of seed 0 of big/map"
    note_drawing(2)
    assert activity(task(7, 9), timer, False) == "drawing the world of seed 8 of big/map"
    note_drawing(0)
    with calling("reset"):
        assert activity(task(), timer, False) == "preparing orca in big/map, seed 0"
    with calling("act", 340 * 0.2):
        pass
    beat()
    shown = activity(task(7, 9), timer, False)
    assert shown == "orca in big/map, seeds 7 to 8: 340 of 4,000 decisions"
    with calling("remarks"):
        pass
    assert activity(task(), timer, False) == "storing orca in big/map, seed 0"
    assert activity(task(), timer, True) == "measuring orca in big/map, seed 0"


@pytest.mark.parametrize("junk", [math.nan, math.inf, -math.inf, -3.0, 0.5, 1e308])
def test_notes_that_a_navigator_overwrote_raise_nothing(timer, junk):
    for place in range(SIZE):
        with calling("act", 1.0):
            timer.notes[place] = junk
        assert "orca in big/map" in activity(task(), timer, False)
        timer.notes[:] = [2.0, 2.0, 0.0, 0.0, 0.0]


def clocked(display):
    now = [0.0]
    shown = display(clock=lambda: now[0])
    shown.begin(10, 0)
    return shown, now


def test_lines_of_an_activity_come_at_growing_intervals(capsys):
    shown, now = clocked(Lines)
    times = []
    for tenth in range(6000):
        now[0] = tenth / 10
        shown.look(f"decision {tenth}")
        if capsys.readouterr().err == f"decision {tenth}\n":
            times.append(now[0])
    assert times[:4] == [5.0, 12.5, pytest.approx(23.8), pytest.approx(40.7)]
    assert times[-1] - times[-2] == pytest.approx(60.0)


def test_no_activity_is_shown_while_episodes_end(capsys):
    shown, now = clocked(Lines)
    for second in range(1, 10):
        now[0] = float(second)
        shown.look("decision 3")
        shown.advance(1)
    assert "decision" not in capsys.readouterr().err
    now[0] += 5.0
    shown.look("decision 4")
    assert capsys.readouterr().err == "decision 4\n"


def test_lines_show_compilation_before_a_worker_begins(capsys, monkeypatch):
    monkeypatch.setattr(progress, "compiled_since", lambda moment: 34)
    shown, now = clocked(Lines)
    now[0] = 6.0
    shown.look("")
    assert capsys.readouterr().err == "compiling kernels, once per version: 34 so far\n"


def test_a_terminal_shows_the_activity_below_the_bar(monkeypatch):
    shown, now = clocked(Bar)
    try:
        shown.look("drawing the world of seed 0 of big/map")
        assert "drawing" not in rendered(shown)
        now[0] = 5.0
        assert rendered(shown).splitlines()[1] == "drawing the world of seed 0 of big/map"
        shown.advance(1)
        assert "drawing" not in rendered(shown)
    finally:
        shown.end()


def rendered(bar):
    console = Console(file=io.StringIO(), width=100)
    console.print(bar._bar.get_renderable())
    return console.file.getvalue()


class Activities(Progress):
    def __init__(self):
        self.seen = []

    def look(self, activity):
        self.seen.append(activity)


def test_the_activity_of_a_worker_reaches_the_display(tmp_path, scenario_file, troubled):
    suite = tmp_path / "suite.yaml"
    suite.write_text(
        f"name: small\nscenarios: [{scenario_file}]\n"
        "navigators: [{type: 'troubled_navigators:Slow', label: slow}]\nseeds: '3:4'\n"
    )
    seen = Activities()
    run_suite(load_suite(str(suite), Selection()), tmp_path / "run", workers=1, progress=seen)
    assert any(", seed 3: " in text and text.startswith("slow in ") for text in seen.seen)
