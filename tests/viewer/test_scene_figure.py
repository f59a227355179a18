"""Figures and moving pictures of episodes, read off before and after they are written."""

import sys

import numpy as np
import pytest
from PIL import Image

import benchnav
from benchnav.drawing.palette import TEAMS, agent_color
from benchnav.errors import MissingExtraError, StoreError, UsageError
from benchnav.testing.zoo import zoo
from benchnav.viewer.animation import frame_times
from benchnav.viewer.episode_film import EpisodeFilm
from benchnav.viewer.scene_figure import episode_figure, world_figure

pytest.importorskip("matplotlib")


@pytest.fixture(scope="module")
def episode():
    world = benchnav.load_scenario("leaders/dynamic").world(seed=7)
    return benchnav.simulate(world, "straight-line", track="unknown")


def test_the_arena_is_not_painted_over():
    """The outer wall is a loop that runs clockwise: its inside is free."""
    figure = world_figure(benchnav.load_scenario("trap/u").world(seed=0).record)
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())[..., :3]
    assert (pixels == 255).all(axis=-1).mean() > 0.8


def test_trails_marks_and_crosses(episode):
    (axes,) = episode_figure([episode.record]).axes
    record = episode.record
    crosses = [line for line in axes.lines if line.get_marker() == "x"]
    lost = np.flatnonzero(~np.isfinite(record.arrival))
    assert len(crosses) == len(lost)
    for cross, agent in zip(crosses, lost, strict=True):
        assert cross.get_color() == TEAMS[agent]
    assert axes.get_title() == f"straight-line: {4 - len(lost)} of 4 arrived"


def test_the_first_picture_of_a_world_has_a_scale(episode):
    other = benchnav.load_scenario("trap/u").world(seed=0)
    there = benchnav.simulate(other, "straight-line").record
    axes = episode_figure([episode.record, episode.record, there]).axes
    assert [[text.get_text() for text in a.texts] for a in axes] == [["5 m"], [], ["10 m"]]
    for a, length in ((axes[0], 5.0), (axes[2], 10.0)):
        left, right = a.lines[-1].get_xdata()
        assert right - left == length


def test_snapshots_stand_in_a_row(episode):
    axes = episode_figure([episode.record] * 2, [0.0, 1.0, 2.0]).axes
    assert [a.get_title() for a in axes[:3]] == ["straight-line, 0 s", "1 s", "2 s"]
    assert len(axes) == 6
    for times, sentence in (([99.0], "from 0 to"), ([0.1] * 9, "8 times at most")):
        with pytest.raises(UsageError, match=sentence):
            episode_figure([episode.record], times)


@pytest.mark.parametrize("suffix", [".png", ".svg", ".pdf"])
def test_equal_episodes_give_equal_figures(episode, tmp_path, suffix):
    files = [episode.replay().save(tmp_path / f"{n}{suffix}") for n in range(2)]
    assert files[0].read_bytes() == files[1].read_bytes()


@pytest.mark.slow
def test_a_gif_moves(episode, tmp_path):
    path = episode.replay().save(tmp_path / "a.gif")
    with Image.open(path) as picture:
        lasts = (picture.n_frames - 1) * picture.info["duration"] / 1000
        assert lasts == pytest.approx(episode.duration, abs=0.1)  # shorter than 10 s
        first = np.asarray(picture.convert("RGB")).copy()
        picture.seek(picture.n_frames - 1)
        assert (np.asarray(picture.convert("RGB")) != first).any()


@pytest.mark.slow
def test_a_film_has_25_frames_a_second(episode, tmp_path):
    ffmpeg = pytest.importorskip("imageio_ffmpeg")
    path = episode.replay().save(tmp_path / "a.mp4")
    frames, seconds = ffmpeg.count_frames_and_secs(str(path))
    assert frames == len(frame_times([episode.record], 25)) == round(25 * episode.duration) + 1
    assert seconds == pytest.approx(episode.duration, abs=0.1)
    assert next(ffmpeg.read_frames(str(path)))["size"][0] >= 800
    with pytest.raises(StoreError, match="must be writable"):
        episode.replay().save(path / "a.mp4")


@pytest.mark.parametrize(
    ("module", "suffix", "extra"),
    [
        ("matplotlib.figure", ".png", "view"),
        ("imageio_ffmpeg", ".mp4", "video"), ("mcap_protobuf.writer", ".mcap", "mcap"),
        ("rerun", ".rrd", "rerun"),
    ],
)  # fmt: skip
def test_a_missing_library_is_named_with_its_extra(
    episode, tmp_path, monkeypatch, module, suffix, extra
):
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(MissingExtraError, match=rf"benchnav\[{extra}\]"):
        episode.replay().save(tmp_path / f"a{suffix}")
    assert not list(tmp_path.iterdir())


def test_times_are_for_figures(episode, tmp_path):
    with pytest.raises(UsageError, match="Times are for a figure"):
        episode.replay().save(tmp_path / "a.gif", [1.0])


def test_a_world_is_plotted(tmp_path):
    world = benchnav.load_scenario("leaders/dynamic").world(seed=0)
    world.plot(tmp_path / "w.png")
    with Image.open(tmp_path / "w.png") as picture:
        assert min(picture.size) > 300
    with pytest.raises(UsageError, match="must end in"):
        world.plot(tmp_path / "w.txt")


def test_agents_that_enter_later_have_no_trail_mark_or_cross_before():
    late = zoo()["late"]
    for time, trails in ((2.0, 1), (6.0, 2), (None, 2)):
        axes = episode_figure([late], [] if time is None else [time]).axes[0]
        assert len(axes.collections) == trails
        assert not [line for line in axes.lines if line.get_marker() == "x"]


def test_a_film_shows_an_agent_from_its_entry_on():
    late = zoo()["late"]
    film = EpisodeFilm(late, np.array([24.0, 16.0]), 480)
    color = np.array([int(agent_color(late.world, 1)[k : k + 2], 16) for k in (1, 3, 5)])

    def painted(time):
        return int((np.abs(film.frame(time).astype(int) - color).max(axis=-1) < 8).sum())

    assert painted(2.0) < painted(5.0) - 20
