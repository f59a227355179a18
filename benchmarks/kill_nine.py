"""Kills a run at random moments until it has survived: ``python -m benchmarks.kill_nine``.

A suite is run by the command, with workers, in a process group of its own. At a random
moment the whole group gets SIGKILL (or, with ``--parent-only``, the command alone, which
its workers must not outlive), and the same command goes on in the same folder. A run that
reaches its end is compared with one that nobody disturbed, every value and every line of
the table, timings aside, and the next begins in a new folder, until there were so many kills.
"""

import argparse
import contextlib
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from benchnav.leaderboard import leaderboard, render
from benchnav.metrics.measure import all_metrics
from benchnav.processes.process_tree import tree
from benchnav.store.part import SEAL
from benchnav.store.part_writer import TEMPORARY
from benchnav.store.reading import read_episodes, read_results

COMMAND = (sys.executable, "-c", "from benchnav.cli.main import main; main()")
SALT = "9e" * 16
_TIMED = {"rehearsal_seconds"}  # columns


@dataclass
class Tally:
    """What happened."""

    kills: int = 0
    finished: int = 0  # runs that reached their end, and were compared
    seconds: list[float] = field(default_factory=list)  # from start to kill
    states: Counter[str] = field(default_factory=Counter)  # what was on disk at the kill


def survive(
    suite: str, folder: Path, times: int, *, options: tuple[str, ...] = (),
    parent_only: bool = False, seed: int = 0, within: float | None = None,
) -> Tally:  # fmt: skip
    """Kill runs of a suite ``times`` times, ``within`` so many [s] of their begin or any time.

    Raises AssertionError where one ends differently.
    """
    moments, tally = random.Random(seed), Tally()
    whole = folder / "whole"
    began = time.monotonic()
    subprocess.run(_command(suite, whole, options), check=True, stdout=subprocess.DEVNULL)
    span = within or time.monotonic() - began
    before = facts(whole)
    out = folder / "run-0"
    while tally.kills < times or out.exists() or not tally.finished:
        left = tally.kills < times
        process = subprocess.Popen(
            _command(suite, out, options), stdout=subprocess.DEVNULL, start_new_session=True
        )
        moment = moments.uniform(0.0, span) if left else None
        try:
            code = process.wait(moment)
        except subprocess.TimeoutExpired:
            tally.states[_state(out)] += 1
            _kill(process, parent_only)
            tally.kills += 1
            tally.seconds.append(moment or 0.0)
            if tally.kills % 10 == 0:
                print(f"{tally.kills} of {times} kills", file=sys.stderr, flush=True)
            continue
        assert code == 0, f"the command ended with status {code}"
        _compare(facts(out), before)
        assert not list(out.rglob(f"{TEMPORARY}*")), "leftovers"
        tally.finished += 1
        shutil.rmtree(out)
        out = folder / f"run-{tally.finished}"
        if not left:
            break
    return tally


def _compare(found: tuple[list[str], ...], before: tuple[list[str], ...]) -> None:
    for now, then in zip(found, before, strict=True):
        differing = [pair for pair in zip(now, then, strict=False) if pair[0] != pair[1]]
        assert not differing, f"{len(differing)} differ, first {differing[0]}"
        assert len(now) == len(then), f"{len(now)} for {len(then)}"


def facts(run: Path) -> tuple[list[str], ...]:
    """Digests, measured values and the table of a run, timings aside."""
    metrics = {m.name: m for m in all_metrics()}
    kept = [name for name, metric in metrics.items() if metric.verifiable]
    results = read_results(run)
    rows = sorted(
        str({k: v for k, v in row.items() if k not in _TIMED})
        for row in results.to_pylist()
        if row["metric"] in kept
    )
    table = render(leaderboard(results, metrics), "markdown", kept)
    episodes = [f"{e.identity} {e.digest}" for e in read_episodes(run)]
    return episodes, rows, table.splitlines()


def _command(suite: str, out: Path, options: tuple[str, ...]) -> list[str]:
    return [*COMMAND, "run", suite, "--out", str(out), "--salt", SALT, "--quiet", *options]


def _kill(process: "subprocess.Popen[bytes]", parent_only: bool) -> None:
    others = tree(process.pid)[1:]
    if parent_only:
        process.kill()
    else:
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    for pid in others:  # gone, or about to be
        while _runs(pid):
            time.sleep(0.001)


def _runs(pid: int) -> bool:
    with contextlib.suppress(OSError):
        return Path(f"/proc/{pid}/stat").read_text().rpartition(") ")[2][0] != "Z"
    return False


def _state(out: Path) -> str:
    if not (out / "manifest.json").exists():
        return "before the manifest"
    if list(out.glob(f"parts/*/{TEMPORARY}*")):
        return "writing a part"
    stored = len([p for p in out.glob(f"parts/*/*{SEAL}") if not p.name.startswith(TEMPORARY)])
    return "between parts" if stored else "before the first part"


def main() -> None:
    """Kill, and say what came of it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--times", type=int, default=100)
    parser.add_argument("--suite", default="quick")
    parser.add_argument("--seeds", default="40")
    parser.add_argument("--navigator", action="append", help="instead of the suite's")
    parser.add_argument("--workers", default="2")
    parser.add_argument("--within", type=float, help="[s] until the latest kill")
    parser.add_argument("--parent-only", action="store_true")
    parser.add_argument("--seed", type=int, default=0, help="of the moments")
    asked = parser.parse_args()
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        tally = survive(
            asked.suite, Path(folder), asked.times, parent_only=asked.parent_only, seed=asked.seed,
            within=asked.within, options=("--seeds", asked.seeds, "--workers", asked.workers,
            *(word for name in asked.navigator or () for word in ("--navigator", name))),
        )  # fmt: skip
    who = "the command alone" if asked.parent_only else "the whole process group"
    print(
        f"{tally.kills} kills of {who}, {min(tally.seconds):.1f} to {max(tally.seconds):.1f} s"
        f" after it began; {tally.finished} runs reached their end, each equal to the unbroken"
        f" one. At the kill: {dict(tally.states)}. {time.monotonic() - began:.0f} s."
    )


if __name__ == "__main__":
    main()
