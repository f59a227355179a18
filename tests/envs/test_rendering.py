"""Pictures of environments: of the right size, of the world that is stepped, and moving."""

import shutil
import subprocess
import sys
from itertools import pairwise
from types import ModuleType

import gymnasium
import numpy as np
import pytest
from stable_baselines3.common.vec_env import VecVideoRecorder

import benchnav
from benchnav import make_env
from benchnav.drawing.palette import HIT, TEAMS
from benchnav.drawing.top_view import TopView, spans
from benchnav.envs.factory import NoRenderingError
from benchnav.envs.gym.leader_env import LeaderEnv
from benchnav.envs.gym.leader_vector_env import LeaderVectorEnv
from benchnav.envs.parallel_env import LeadersEnv
from benchnav.envs.rendering import Renderer
from benchnav.errors import UsageError
from tests.worlds import agents, world

XVFB = shutil.which("Xvfb")


def rgb(text):
    return [int(text[n : n + 2], 16) for n in (1, 3, 5)]


@pytest.fixture(scope="module")
def drawn():
    return benchnav.load_scenario("leaders/dynamic").world(seed=7).record


def test_everything_is_where_it_stands(drawn):
    """The colour at the centre of each thing, through the frame of the picture."""
    view = TopView(drawn, 480)
    position = drawn.agents.start
    bodies = np.array([body.law.points[0] for body in drawn.bodies])
    picture = view.draw(position, drawn.agents.heading, bodies, np.ones(4, bool)).array()
    assert max(picture.shape[:2]) == 480
    x0, y0, x1, y1 = drawn.bounds
    rim = 0.015 * max(x1 - x0, y1 - y0)
    scale = 480 / (max(x1 - x0, y1 - y0) + 2 * rim)

    def at(x, y):
        return picture[int((y1 + rim - y) * scale), int((x - x0 + rim) * scale)].tolist()

    for color, (x, y), radius, heading in zip(
        TEAMS, position, drawn.agents.radius, drawn.agents.heading, strict=False
    ):
        behind = x - 0.5 * radius * np.cos(heading), y - 0.5 * radius * np.sin(heading)
        assert at(*behind) == rgb(color)
    for x, y in bodies:
        assert at(x, y) == rgb("#e07a3f")
    assert at(x0 - 0.5 * rim, 0.5 * (y0 + y1)) == rgb("#36454f")
    assert (picture == 255).all(axis=-1).mean() > 0.6  # the arena is not painted over


def test_the_gymnasium_environment_is_drawn():
    env = gymnasium.wrappers.RenderCollection(
        LeaderEnv("leaders/dynamic", worlds=2, others="straight-line", render_mode="rgb_array")
    )
    with pytest.raises(UsageError, match="call reset"):
        env.unwrapped.render()
    env.reset(seed=0)
    for _ in range(3):
        env.step(np.array([1.0, 0.0], np.float32))
    frames = env.render()
    assert [frame.shape for frame in frames] == [frames[0].shape] * 4
    assert frames[0].dtype == np.uint8
    assert all((one != other).any() for one, other in pairwise(frames))
    assert LeaderEnv("leaders/static", worlds=2, others="orca").render() is None


def test_the_pettingzoo_environment_is_drawn():
    env = LeadersEnv("leaders/static", worlds=2, render_mode="rgb_array")
    with pytest.raises(UsageError, match="call reset"):
        env.render()
    env.reset(seed=0)
    first = env.render()
    env.step({agent: np.array([1.0, 0.5], np.float32) for agent in env.agents})
    assert (env.render() != first).any()


def test_pictures_of_a_pool_have_one_size():
    """Worlds of different sizes: a film needs equal frames."""
    wide, high = (world(agents([[1, 1]], [[2, 2]]), side=side) for side in (4.0, 8.0))
    view = TopView(wide, 100, span=spans((wide, high)))
    assert view.background.array().shape == TopView(high, 100).background.array().shape


def test_the_last_picture_is_of_the_world_in_which_the_attempt_ended():
    """One agent alone: its end is the end of the row, which starts again only with `reset`."""
    env = LeaderEnv("leaders/dynamic", worlds=3, others="straight-line", render_mode="rgb_array")
    for seed in range(3):
        _, info = env.reset(seed=seed)
        over = False
        while not over:
            _, _, *ends, _ = env.step(np.array([1.0, 0.0], np.float32))
            over = any(ends)
        assert env.batch.simulation.worlds[0] is env.batch.simulation.pool[info["world"]]
    # the same where all agents learn
    env = LeadersEnv("leaders/static", worlds=3, render_mode="rgb_array")
    env.reset(seed=0)
    while env.agents:
        before = env.batch.simulation.worlds[0]
        env.step({agent: np.array([1.0, 0.0], np.float32) for agent in env.agents})
    assert env.batch.simulation.worlds[0] is before
    hit = np.array(rgb(HIT))
    assert (np.abs(env.render().astype(int) - hit) < 8).all(axis=-1).any()  # a cross


def test_a_vector_environment_has_a_picture_for_each_slot():
    env = LeaderVectorEnv(8, "leaders/dynamic", worlds=3, render_mode="rgb_array")
    with pytest.raises(UsageError, match="call reset"):
        env.render()
    env.reset(seed=0)
    frames = env.render()
    assert len(frames) == 8
    assert {(frame.shape, frame.dtype) for frame in frames} == {((240, 240, 3), np.dtype("u1"))}
    assert all((one != other).any() for one, other in pairwise(frames))  # rings
    first, second = (Renderer(env.batch.simulation, 240).frame(row) for row in (0, 1))
    assert (first != second).any()
    for n, frame in enumerate(frames):
        same = [(frame != row).any(axis=-1).mean() for row in (first, second)]
        assert same[n // 4] < 0.02 < same[1 - n // 4]
    assert LeaderVectorEnv(8, "leaders/dynamic", worlds=3).render() is None
    with pytest.raises(NoRenderingError, match="None or 'rgb_array'"):
        LeaderVectorEnv(8, "leaders/dynamic", worlds=3, render_mode="human")


@pytest.fixture
def moviepy(monkeypatch):
    """MoviePy, or its one class that the wrappers use: MoviePy does not allow Pillow 12."""
    try:
        import moviepy  # noqa: F401
    except ImportError:
        ffmpeg = pytest.importorskip("imageio_ffmpeg")

        class ImageSequenceClip:
            def __init__(self, frames, fps):
                self.frames, self.fps = frames, fps

            def write_videofile(self, path, **_):
                high, wide = self.frames[0].shape[:2]
                out = ffmpeg.write_frames(path, (wide, high), fps=self.fps, macro_block_size=2)
                out.send(None)
                for frame in self.frames:
                    assert frame.dtype == np.uint8
                    out.send(np.ascontiguousarray(frame))
                out.close()

        for name in ("moviepy", "moviepy.video", "moviepy.video.io"):
            monkeypatch.setitem(sys.modules, name, ModuleType(name))
        module = ModuleType("moviepy.video.io.ImageSequenceClip")
        module.ImageSequenceClip = ImageSequenceClip
        monkeypatch.setitem(sys.modules, module.__name__, module)
    return pytest.importorskip("imageio_ffmpeg")


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*autoreset mode is same-step")
def test_gymnasium_records_vector_environments(moviepy, tmp_path):
    env = make_env("leaders/dynamic", num_worlds=2, worlds=3, render_mode="rgb_array")
    films = gymnasium.wrappers.vector.RecordVideo(
        env, str(tmp_path / "films"), step_trigger=lambda step: step == 0, video_length=6
    )
    films.reset(seed=0)
    for _ in range(8):
        films.step(np.tile(np.float32([1.0, 0.1]), (8, 1)))
    films.close()
    (film,) = (tmp_path / "films").glob("*.mp4")
    assert moviepy.count_frames_and_secs(str(film))[0] == 7  # the start, and each step


@pytest.mark.slow
def test_stable_baselines_records_its_environments(moviepy, tmp_path, capsys):
    env = make_env("leaders/dynamic", num_worlds=2, worlds=3, kind="sb3", render_mode="rgb_array")
    with pytest.raises(UsageError, match="call reset"):
        env.render()
    films = VecVideoRecorder(env, str(tmp_path / "films"), lambda step: step == 0, 6)
    films.reset()
    assert films.render().shape == (960, 480, 3)  # two worlds in one picture
    for _ in range(8):
        films.step(np.tile(np.float32([1.0, 0.1]), (8, 1)))
    films.close()
    (film,) = (tmp_path / "films").glob("*.mp4")
    assert moviepy.count_frames_and_secs(str(film))[0] == 7


def human_environments():
    action = np.array([1.0, 0.0], np.float32)
    env = make_env(
        "leaders/dynamic", kind="gymnasium", worlds=2, others="orca", render_mode="human"
    )
    yield env, lambda: env.step(action)
    several = make_env("leaders/dynamic", kind="pettingzoo", worlds=2, render_mode="human")
    yield several, lambda: several.step(dict.fromkeys(several.agents, action))


@pytest.fixture
def display(monkeypatch):
    """A display that nothing shows."""
    if XVFB is None:
        pytest.skip("no Xvfb is installed")
    command = [XVFB, "-displayfd", "1", "-screen", "0", "800x600x24", "-nolisten", "tcp"]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    ) as server:
        monkeypatch.setenv("DISPLAY", f":{server.stdout.readline().strip()}")
        yield
        server.terminate()


def test_a_window_shows_every_decision(display):
    for env, step in human_environments():
        env.reset(seed=0)
        window = env._display._window
        first = window._label.image
        assert (first.width(), first.height()) == (480, 480)
        before = window._next
        step()
        assert window._label.image is not first
        assert window._next - before >= 0.19  # in real time
        assert env.render() is None
        window._root.eval(window._root.protocol("WM_DELETE_WINDOW"))  # the user closes it
        assert not window.is_open
        step()
        env.close()
        env.close()


def test_a_window_needs_a_display(monkeypatch):
    monkeypatch.delenv("DISPLAY", raising=False)
    with pytest.raises(NoRenderingError, match="needs a display"):
        next(human_environments())
    monkeypatch.setitem(sys.modules, "tkinter", None)
    with pytest.raises(NoRenderingError, match="needs tkinter"):
        next(human_environments())
