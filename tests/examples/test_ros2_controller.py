"""The example for ROS 2, driven through its socket by nodes without ROS."""

import re
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from contextlib import contextmanager
from pathlib import Path

import pytest
import yaml

from benchnav.errors import ConfigError, NavigatorError
from benchnav.metrics.success import success
from benchnav.navigation.plugin.configure import make
from benchnav.plugins import NAVIGATORS
from benchnav.runner.plan.suite import Selection, load_suite
from benchnav.runner.rollouts.rollout import Assignment, rollout
from benchnav.runner.run import run_suite
from benchnav.store.runs.reading import episodes_of
from benchnav.store.runs.run_folder import RunFolder
from benchnav.verify.verify import Wanted, verify
from tests.worlds import agents, world

EXAMPLE = Path(__file__).parents[2] / "examples" / "ros2_controller"
STUB = EXAMPLE / "stub_node.py"
FAULTY = Path(__file__).with_name("faulty_node.py")

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="needs Unix sockets")


@contextmanager
def node(program, *arguments):
    """Start a node, and yield the path of its socket (short, as the system demands)."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "s")
        started = subprocess.Popen([sys.executable, program, path, *arguments])
        try:
            deadline = time.monotonic() + 30
            while not path.exists() and time.monotonic() < deadline:
                time.sleep(0.01)
            time.sleep(0.05)  # until it listens
            yield str(path)
        finally:
            started.kill()
            started.wait()


def spec(path, **config):
    command = [sys.executable, str(EXAMPLE / "navigator.py")]
    config = {"socket": path, "reproducible": True, **config}
    return {"type": "process", "command": command, "config": config}


def start(path):
    """Start the program, and return the properties that it reports."""
    return make(NAVIGATORS, spec(path)).capabilities


def play(path, count=1, **config):
    some = [
        (k, world(agents([[5.0, 5.0], [9.0, 5.0 + k]], [[15.0, 5.0], [5.0, 9.0]]), steps=10))
        for k in range(count)
    ]
    assignment = Assignment("s", "h", "test", "unknown", "ros2", spec(path, **config), salt="00")
    return [episode for batch in rollout(assignment, some) for episode in batch]


@pytest.mark.slow
def test_the_suite_of_the_readme(tmp_path, monkeypatch):
    """Success is above that of straight-line, and the run can be repeated bit for bit."""
    text = (EXAMPLE / "README.md").read_text("utf-8")
    suite = yaml.safe_load(re.search(r"# file: ros2.yaml\n(.*?)```", text, re.DOTALL)[1])
    monkeypatch.chdir(EXAMPLE.parents[1])
    with node(STUB, "--speed", "1.2") as path:
        entry = suite["navigators"][1]
        entry["command"] = [sys.executable, *entry["command"][1:]]
        entry["config"]["socket"] = path
        (tmp_path / "ros2.yaml").write_text(yaml.safe_dump(suite))
        loaded = load_suite(str(tmp_path / "ros2.yaml"), Selection())
        run_suite(loaded, tmp_path / "run", workers=0)
        run = RunFolder.open(tmp_path / "run")
        report = verify(run, Wanted(twin=0, rerun=True), workers=0)
    assert report.clean, report.findings
    assert report.counts["rerun"] == 12
    rates = defaultdict(list)
    for episode in episodes_of(run):
        assert episode.failure == ""
        about = episode.identity
        rates[about.scenario, about.navigator].append(float(success(episode).mean()))
    means = {key: sum(values) / len(values) for key, values in rates.items()}
    for scenario in {scenario for scenario, _ in means}:
        assert means[scenario, "ros2"] > means[scenario, "straight-line"] + 0.2, means


def test_a_twist_without_a_stamp_drives_the_same_way():
    with node(STUB) as path:
        (stamped,), (bare,) = play(path), play(path, stamped=False, people=True)
    assert stamped.failure == ""
    assert (stamped.requested == bare.requested).all()
    assert stamped.requested.any()


def test_a_file_that_is_no_socket_is_kept(tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    started = subprocess.run([sys.executable, STUB, tmp_path / "notes.txt"], capture_output=True)
    assert started.returncode == 1
    assert (tmp_path / "notes.txt").read_text() == "mine"


def test_worlds_run_one_at_a_time():
    with node(STUB) as path:
        together = play(path, count=3)
    assert [e.failure for e in together] == [""] * 3
    assert sorted(e.identity.seed for e in together) == [0, 1, 2]


@pytest.mark.parametrize(
    ("fault", "cause"),
    [
        ("silent", "act: the node at {path} did not answer within 1 s at t = 0.4 s"),
        ("dies", "act: the node at {path} closed the connection at t = 0.4 s"),
        ("closes", "act: the node at {path} closed the connection at t = 0.4 s"),
        ("garbage", "act: the node at {path} must send a JSON object per line. Got b'cmd_vel = 1"),
        ("nan", "act must return finite numbers. Got (nan, 0) for agent 0 instead at t = 0.4 s"),
        ("sideways", "act: cmd_vel must have linear.y = 0, because the body cannot move sideways."),
        ("other type", "act: cmd_vel must be a Twist or a TwistStamped. Got {{'twist': {{'data'"),
    ],
)
def test_a_node_that_fails_costs_the_episode(fault, cause):
    with node(FAULTY, fault) as path:
        (episode,) = play(path, timeout=1.0)
        assert episode.failure.startswith(cause.format(path=path))
    assert not success(episode).any()


@pytest.mark.parametrize(
    ("missing", "moves", "failure"),
    [
        ("stop", False, ""),
        ("hold", True, ""),
        ("fail", False, "act: no cmd_vel of robot 0 came in time at t = 0.4 s"),
    ],
)
def test_a_robot_without_cmd_vel(missing, moves, failure):
    with node(FAULTY, "mute") as path:
        (episode,) = play(path, missing=missing)
    assert episode.failure == failure
    if not failure:
        assert (episode.requested[:2] == [0.5, 0.0]).all()
        assert (episode.requested[2:] == [0.5 * moves, 0.0]).all()
        assert episode.remarks == (f"16 commands did not come in time (missing: {missing})",)


def test_a_range_that_is_not_that_of_the_rays_is_refused():
    with node(STUB) as path:
        (episode,) = play(path, range_max=4.0)
    assert "range_max must be the range of the scenario's rays. Got 4 m" in episode.failure


def test_a_node_must_listen_before_the_run(tmp_path):
    with pytest.raises(NavigatorError, match=r"no node listens at .*Start the node first"):
        start(str(tmp_path / "nothing"))
    with node(FAULTY, "greeting") as path, pytest.raises(NavigatorError, match="must greet with"):
        start(path)
    with pytest.raises(ConfigError, match="an absolute path"):
        start("s.sock")
