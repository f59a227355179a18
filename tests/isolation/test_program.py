"""A program as a navigator: what it is told, and what becomes of it when it misbehaves."""

import sys
from pathlib import Path

import numpy as np
import pytest

from benchnav.errors import BrokenPluginError, ConfigError, NavigatorError
from benchnav.isolation.frame import encode
from benchnav.isolation.navigator_process import Process
from benchnav.navigation.plugin.configure import make
from benchnav.plugins import NAVIGATORS
from benchnav.runner.plan.suite import Selection, load_suite
from benchnav.runner.rollouts.rollout import Assignment, rollout
from benchnav.testing.check_navigator import check_navigator
from tests.worlds import agents, world

STRANGER = str(Path(__file__).parent / "stranger.py")


def spec(how, **more):
    return {"type": "process", "command": [sys.executable, STRANGER, how], **more}


def play(how, count=1, **more):
    some = [
        (k, world(agents([[5.0, 5.0], [9.0, 5.0 + k]], [[15.0, 5.0], [5.0, 9.0]]), steps=10))
        for k in range(count)
    ]
    assignment = Assignment("s", "h", "test", "known", how, spec(how, **more), salt="00")
    episodes = [episode for batch in rollout(assignment, some) for episode in batch]
    assert sorted(e.identity.seed for e in episodes) == list(range(count))
    return episodes


def test_its_commands_are_what_is_done():
    (episode,) = play("still")
    assert episode.failure == ""
    assert episode.requested.shape == (10, 2, 2)
    assert (episode.requested == 0.25).all()


def test_it_keeps_the_contract():
    check_navigator(lambda: make(NAVIGATORS, spec("still")))


def test_it_is_told_its_config_and_its_talk_is_passed_on(capsys):
    make(NAVIGATORS, spec("echo", config={"gain": 2.5}))._request("remarks", {"row": 0})
    assert "{'gain': 2.5}" in capsys.readouterr().err


def test_what_it_has_to_tell_is_kept():
    assert [e.remarks for e in play("remarks", count=2)] == [("I was here",)] * 2
    assert play("still")[0].remarks == ()


@pytest.mark.parametrize(
    ("how", "cause"),
    [
        ("exits", "act: its process ended with exit status 1 (out of fuel) at t = 0.4 s"),
        ("dies in reset", "reset: its process "),
        ("nan", "act must return finite numbers. Got (nan, nan) for agent 0 instead at t = 0 s"),
        ("shape", "act must return an array of shape (1, 2, 2). Got shape (1, 2, 3) instead at"),
        ("flags", "act must return real numbers. Got dtype bool instead at t = 0 s"),
        (
            "prints",
            "act: its process answered something that is not a frame: no frame begins with"
            " b'a line",
        ),
        ("refuses", "lost at t = 0.4 s"),
        ("other", "act: its process must answer 'command'. Got 'done' instead at t = 0.4 s"),
        (
            "twice",
            "act: its process sent more bytes than its answer 'command' announces at t = 0.4 s",
        ),
    ],
)
def test_its_episode_is_charged_with_the_cause(how, cause):
    (episode,) = play(how)
    assert episode.failure.startswith(cause)
    assert (episode.status[-1] == episode.status.max()).all()


def test_an_answer_to_no_request_is_refused():
    (episode,) = play("late")
    assert episode.failure.startswith("act: its process sent more bytes than its")


def test_an_answer_before_the_end_of_the_request_is_refused():
    frame = encode("done", {})
    answers = f"import os, time; os.write(1, {bytes(frame)!r}); time.sleep(60)"
    process = Process([sys.executable, "-c", answers])
    with pytest.raises(NavigatorError, match="before it had read the whole request"):
        process.request("reset", {"much": np.zeros(1 << 20)}, 30.0)


def test_it_is_hung_once_its_patience_is_over():
    (episode,) = play("hangs", patience=0.5)
    assert episode.failure == "act: its process did not answer within 0.5 s at t = 0.4 s"


def test_every_world_of_a_batch_is_tried_alone():
    assert {e.failure for e in play("exits", count=3)} == {
        "act: its process ended with exit status 1 (out of fuel) at t = 0.4 s"
    }


@pytest.mark.parametrize(
    ("how", "cause"),
    [
        ("dies at once", "its process ended with exit status 1 (no licence)"),
        ("strange", "must answer 'hello' with the fields in docs/isolation.md: needs.0"),
    ],
)
def test_what_cannot_be_started_is_asked_wrongly_and_in_a_run_charged(how, cause):
    with pytest.raises(BrokenPluginError, match="The navigator 'process' cannot be used") as told:
        load_suite("quick", Selection(navigators=(str(spec(how)),)))
    assert cause in str(told.value)
    assert {e.failure for e in play(how, count=2)} == {e.failure for e in play(how)}
    assert cause in play(how)[0].failure


def test_a_program_must_be_one():
    with pytest.raises(ConfigError, match=r"'command'.*\./nothing"):
        make(NAVIGATORS, {"type": "process", "command": ["./nothing"]})


def test_its_fingerprint_is_that_of_its_files(tmp_path):
    file = tmp_path / "navigator"
    file.write_text("#!/bin/sh\n")
    file.chmod(0o755)
    one = make(NAVIGATORS, {"type": "process", "command": [str(file)]}).fingerprint
    file.write_text("#!/bin/sh\n\n")
    assert make(NAVIGATORS, {"type": "process", "command": [str(file)]}).fingerprint != one


def test_it_ends_with_its_navigator():
    navigator = make(NAVIGATORS, spec("still"))
    assert navigator.required == frozenset()
    process = navigator.process
    assert process.alive
    del navigator
    process.stop()
    assert not process.alive
    with pytest.raises(NavigatorError, match="its process"):
        process.request("hello", {}, 1.0)


def test_the_host_is_a_program_like_any():
    command = [sys.executable, "-m", "benchnav.isolation.host", "straight-line"]
    told = {"type": "process", "command": command}
    some = [(0, world(agents([[5.0, 5.0]], [[15.0, 5.0]]), steps=10))]
    runs = [
        next(rollout(Assignment("s", "h", "test", "known", "x", navigator, salt="00"), some))[0]
        for navigator in ("straight-line", told)
    ]
    assert np.array_equal(runs[0].position, runs[1].position)
    assert runs[1].failure == ""
