"""Signals that end a command: one sentence, the documented status, and nothing left behind."""

import os
import signal
import subprocess
import sys
import time

import pytest

from benchnav.processes.process_tree import tree

HANGS = (
    "import sys, time, {module} as m;"
    "pause = lambda: [time.sleep(0.05) for _ in range(2000)];"  # a signal may just miss a sleep
    "m.{name} = lambda *a, **k: (print('now', file=sys.stderr, flush=True), pause());"
)
MAIN = "from benchnav.cli.main import main; main()"
STATUS = {signal.SIGINT: 130, signal.SIGTERM: 143, signal.SIGHUP: 129}


@pytest.fixture
def begin(tmp_path):
    """Begin a command whose function ``hangs`` hangs; returns once it does."""
    begun = []
    temporary = tmp_path / "temporary"
    temporary.mkdir()

    def begin(*arguments, hangs="", ignored=None):
        module, _, name = hangs.partition(":")
        code = (HANGS.format(module=module, name=name) if hangs else "") + MAIN
        process = subprocess.Popen(
            [sys.executable, "-c", code, *map(str, arguments)], text=True, cwd=tmp_path,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True,
            env={**os.environ, "TMPDIR": str(temporary)},
            preexec_fn=lambda: heed(ignored),
        )  # fmt: skip
        begun.append(process)
        for line in process.stderr:
            if line == "now\n":
                return process
        raise AssertionError("it ended")

    yield begin
    for process in begun:
        process.kill()
        process.communicate()


def heed(ignored):
    """Signals as a terminal's commands have them."""
    for number in STATUS:
        signal.signal(number, signal.SIG_IGN if number == ignored else signal.SIG_DFL)


@pytest.fixture
def run(call, suite, tmp_path):
    code, _, stderr = call("run", suite, "--out", tmp_path / "run", "--workers", "0", "--quiet")
    assert code == 0, stderr
    return tmp_path / "run"


def stopped(process, *numbers):
    """(status, stderr) after signals that come at once."""
    everyone = tree(process.pid)
    for number in numbers:
        process.send_signal(number)
    stdout, stderr = process.communicate(timeout=30)
    assert stdout == ""
    assert "Traceback" not in stderr
    assert "Exception ignored" not in stderr
    for pid in everyone:
        ends_soon(pid)
    return process.returncode, stderr


def ends_soon(pid):
    for _ in range(1000):
        try:
            os.kill(pid, 0)
        except ProcessLookupError:
            return
        time.sleep(0.01)
    raise AssertionError(f"{pid} is still there")


@pytest.mark.parametrize("number", STATUS)
def test_every_signal_is_told_in_a_sentence_and_has_its_status(number, run, begin, tmp_path):
    process = begin("pack", "run", "--out", "a.bnrun", hangs="benchnav.store.packs.pack:_copy")
    assert stopped(process, number) == (
        STATUS[number],
        f"Interrupted by {number.name}: the work is not finished. Give the same command again.\n",
    )
    assert not list(tmp_path.glob("*.bnrun"))
    assert not list(tmp_path.glob(".writing*"))


VERBS = {
    "run": (["run", "{suite}", "--out", "new", "--workers", "0"],
            "benchnav.runner.execute.executor:work",
            "0 of 4 episodes stored. To continue, run the same suite with the folder new as out."),
    "merge": (["merge", "run", "--out", "new"], "benchnav.store.runs.merge:_copy",
              "what was copied is kept. The same command continues in new."),
    "verify": (["verify", "run.bnrun", "--workers", "0"], "benchnav.verify.verify:examine",
               "the work is not finished. Give the same command again."),
    "leaderboard": (["leaderboard", "run.bnrun"], "benchnav.leaderboard.from_runs:stored_values",
                    "the work is not finished. Give the same command again."),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(("arguments", "hangs", "sentence"), VERBS.values(), ids=VERBS)
def test_every_verb_says_what_is_kept_and_leaves_nothing(
    arguments, hangs, sentence, run, call, begin, suite, tmp_path
):
    assert call("pack", run, "--out", tmp_path / "run.bnrun")[0] == 0
    process = begin(*(word.format(suite=suite) for word in arguments), hangs=hangs)
    code, stderr = stopped(process, signal.SIGTERM)
    assert code == 143
    assert stderr.splitlines()[-1] == f"Interrupted by SIGTERM: {sentence}"
    assert list((tmp_path / "temporary").iterdir()) == []
    assert not list(tmp_path.glob("*/.writing*"))


def test_ctrl_c_twice_is_as_once(run, begin, tmp_path):
    process = begin("pack", "run", "--out", "a.bnrun", hangs="benchnav.store.packs.pack:_copy")
    code, stderr = stopped(process, signal.SIGINT, signal.SIGINT, signal.SIGTERM)
    assert code in (130, 143)  # who comes first is the system's to decide
    assert stderr.count("\n") == 1
    assert not list(tmp_path.glob(".writing*"))


def test_a_signal_that_is_ignored_stays_ignored(run, begin):
    hangs = "benchnav.store.packs.pack:_copy"
    process = begin("pack", "run", "--out", "a.bnrun", hangs=hangs, ignored=signal.SIGHUP)
    process.send_signal(signal.SIGHUP)
    time.sleep(0.3)
    assert process.poll() is None
    assert stopped(process, signal.SIGTERM)[0] == 143


SLEEPS = """
import sys, time
from benchnav_baselines.navigators.straight_line import StraightLine

class Sleeps(StraightLine):
    def act(self, observation):
        print("now", file=sys.stderr, flush=True)
        time.sleep(100)
"""


@pytest.mark.slow
@pytest.mark.parametrize("more", [[], ["--isolate"]])
def test_workers_and_isolated_processes_go_too(more, suite, begin, tmp_path):
    (tmp_path / "sleeps.py").write_text(SLEEPS)
    arguments = ["--navigator", "sleeps:Sleeps", "--workers", "2", "--out", "new", *more]
    process = begin("run", suite, *arguments)
    code, stderr = stopped(process, signal.SIGTERM)
    assert code == 143
    assert "Interrupted by SIGTERM: 0 of 2 episodes stored. To continue, run" in stderr
    assert list((tmp_path / "temporary").iterdir()) == []
    assert not list(tmp_path.glob("new/parts/*/*"))
