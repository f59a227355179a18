"""Kill commands at random moments, and check that they resume: ``python -m studies.kill_nine``.

A course is a chain of commands that share a folder: a run, shards that are merged, a pack, a
verification. At a random moment the whole process group of a command gets SIGKILL (or, with
``--parent-only``, only the command; its workers must then end too). The same command then
resumes in the same folder. A completed course is compared with an undisturbed one: every value
and every line of the table, except timings. No temporary file, process or lock may be left.
Courses repeat in turn until the number of kills is reached.
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

import pyarrow as pa

from benchnav.leaderboard import leaderboard, render
from benchnav.metrics.measure import all_metrics
from benchnav.processes.process_tree import tree
from benchnav.store.packs.unpack import opened
from benchnav.store.parts.part import SEAL
from benchnav.store.parts.part_writer import TEMPORARY
from benchnav.store.runs.reading import read_episodes, read_rehearsals, read_results
from benchnav.store.runs.run_folder import RunFolder

COMMAND = (sys.executable, "-c", "from benchnav.cli.main import main; main()")
SALT = "9e" * 16
TIMED = "rehearsal_seconds"  # the one column of timings that tables of verifiable metrics show
WITHIN = 0.5  # of the time that a command takes undisturbed, until the latest kill
IN_A_ROW = 5  # kills of one command, before it may reach its end and the next is killed
RUN, PACK = "run", "run.bnrun"  # what a course makes

SUITE = """
name: killed
scenarios: ["groups/crossing:followers=4", trap/u]
tracks: [unknown]
navigators: [orca, random-walk, {type: guided-crowd, rehearsal: 2, leader: orca}]
blocks:
  - {scenarios: ["groups/crossing:followers=4"]}
  - {scenarios: [trap/u], navigators: [orca, random-walk]}
"""


@dataclass(frozen=True)
class Course:
    """Commands, one after the other; the last run that they make is `RUN`."""

    name: str
    commands: tuple[tuple[str, ...], ...]


def courses(suite: str, options: tuple[str, ...]) -> list[Course]:
    """Return what is killed: of a suite with rehearsals, isolation, shards and what follows."""
    run = ("run", suite, "--salt", SALT, "--quiet", *options)
    shards = [(*run, "--shard", f"{k}/2", "--out", f"shard-{k}") for k in (1, 2)]
    return [
        Course("run", ((*run, "--out", RUN),)),
        Course("isolated run", ((*run, "--isolate", "--out", RUN),)),
        Course(
            "shards, merge, pack, verify",
            (
                *shards, ("merge", "shard-1", "shard-2", "--out", RUN), ("pack", RUN),
                ("verify", PACK, "--workers", "2", "--quiet"),
            ),
        ),
    ]  # fmt: skip


@dataclass
class Tally:
    """The counts of one trial."""

    kills: int = 0
    finished: int = 0  # courses that reached their end, and were compared
    seconds: list[float] = field(default_factory=list)  # from start to kill
    states: Counter[str] = field(default_factory=Counter)  # what was killed, and what was on disk


@dataclass
class Killer:
    """Kills commands at random moments."""

    times: int
    moments: random.Random
    parent_only: bool = False
    tally: Tally = field(default_factory=Tally)

    def bring_to_its_end(self, command: tuple[str, ...], folder: Path, span: float) -> None:
        """Give a command again and again until it ends by itself.

        Raises AssertionError where it fails.
        """
        killed = 0
        while True:
            if command[0] == "pack" and (folder / PACK).exists():
                return  # it was killed after its work was done
            process = _begin(command, folder)
            left = self.tally.kills < self.times and killed < IN_A_ROW
            moment = self.moments.uniform(0.0, WITHIN * span) if left else None
            try:
                code = process.wait(moment)
            except subprocess.TimeoutExpired:
                self.tally.states[f"{command[0]}: {_state(folder, command)}"] += 1
                _kill(process, self.parent_only)
                self.tally.kills += 1
                killed += 1
                self.tally.seconds.append(moment or 0.0)
                if self.tally.kills % 10 == 0:
                    print(f"{self.tally.kills} of {self.times}", file=sys.stderr, flush=True)
                continue
            assert code == 0, f"{command[0]} ended with status {code}"
            return


def survive(
    course: Course, folder: Path, times: int, *, parent_only: bool = False, seed: int = 0
) -> Tally:
    """Kill the commands of a course ``times`` times.

    Raises AssertionError where it ends differently from an unbroken one, or leaves something.
    """
    whole = folder / "whole"
    spans = [_seconds_of(command, whole) for command in course.commands]
    before = facts(whole / RUN)
    killer = Killer(times, random.Random(seed), parent_only)
    while killer.tally.kills < times or not killer.tally.finished:
        here = folder / f"life-{killer.tally.finished}"
        for command, span in zip(course.commands, spans, strict=True):
            killer.bring_to_its_end(command, here, span)
        _compare(facts(here / RUN), before)
        _refuse_leftovers(here)
        killer.tally.finished += 1
        shutil.rmtree(here)
    shutil.rmtree(whole)
    return killer.tally


def facts(run: Path) -> tuple[list[str], ...]:
    """Digests, measured values and the table of a run, timings aside."""
    metrics = {m.name: m for m in all_metrics()}
    kept = [name for name, metric in metrics.items() if metric.verifiable]
    results = _without_timings(read_results(run))
    rows = sorted(str(row) for row in results.to_pylist() if row["metric"] in kept)
    table = render(leaderboard(results, metrics), "markdown", kept)
    found = [*read_episodes(run), *read_rehearsals(run)]
    return [f"{e.identity} {e.digest}" for e in found], rows, table.splitlines()


def _without_timings(results: pa.Table) -> pa.Table:
    place = results.column_names.index(TIMED)
    zeros = pa.repeat(pa.scalar(0.0, results.schema.field(TIMED).type), len(results))
    return results.set_column(place, results.schema.field(TIMED), zeros)


def _compare(found: tuple[list[str], ...], before: tuple[list[str], ...]) -> None:
    for now, then in zip(found, before, strict=True):
        differing = [pair for pair in zip(now, then, strict=False) if pair[0] != pair[1]]
        assert not differing, f"{len(differing)} differ, first {differing[0]}"
        assert len(now) == len(then), f"{len(now)} for {len(then)}"


def _refuse_leftovers(folder: Path) -> None:
    """Raise AssertionError where temporary files are left, or a run is locked or not whole."""
    assert not list(folder.rglob(f"{TEMPORARY}*")), "unfinished files"
    with RunFolder.open(folder / RUN).writing() as run:
        assert not dict(run.missing()), "missing episodes"
    if (folder / PACK).exists():
        with opened(folder / PACK) as packed:
            assert not dict(packed.missing()), "missing episodes in the pack"
    left = [path.name for path in _temporary(folder).iterdir()]
    assert not left, f"left among the temporary files: {left}"


def _seconds_of(command: tuple[str, ...], folder: Path) -> float:
    """Give a command once, and return how long it took."""
    began = time.monotonic()
    code = _begin(command, folder).wait()
    assert code == 0, f"{command[0]} ended with status {code}"
    return time.monotonic() - began


def _begin(command: tuple[str, ...], folder: Path) -> "subprocess.Popen[bytes]":
    temporary = _temporary(folder)
    temporary.mkdir(parents=True, exist_ok=True)
    return subprocess.Popen(
        [*COMMAND, *command], cwd=folder, stdout=subprocess.DEVNULL, start_new_session=True,
        stderr=subprocess.DEVNULL if command[0] in ("merge", "pack") else None,
        env={**os.environ, "TMPDIR": str(temporary)},
    )  # fmt: skip


def _temporary(folder: Path) -> Path:
    return folder / "temporary"


def _kill(process: "subprocess.Popen[bytes]", parent_only: bool) -> None:
    others = tree(process.pid)[1:]
    if parent_only:
        process.kill()
    else:
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    until = time.monotonic() + 30.0
    for pid in others:  # gone, or about to be
        while _runs(pid):
            assert time.monotonic() < until, f"process {pid} outlives its parent"
            time.sleep(0.001)


def _runs(pid: int) -> bool:
    with contextlib.suppress(OSError):
        return Path(f"/proc/{pid}/stat").read_text().rpartition(") ")[2][0] != "Z"
    return False


def _state(folder: Path, command: tuple[str, ...]) -> str:
    if command[0] in ("pack", "verify"):
        temporary = [*folder.glob(f"{TEMPORARY}*"), *_temporary(folder).iterdir()]
        return "at work" if temporary else "before or after the work"
    out = folder / command[command.index("--out") + 1]
    if not (out / "manifest.json").exists():
        return "before the manifest"
    if list(out.glob(f"parts/*/{TEMPORARY}*")):
        return "writing a part"
    stored = [p for p in out.glob(f"parts/*/*{SEAL}") if not p.name.startswith(TEMPORARY)]
    return "between parts" if stored else "before the first part"


def main() -> None:
    """Kill, and say what came of it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--suite", help="instead of one with rehearsals")
    parser.add_argument("--seeds", default="12")
    parser.add_argument("--workers", default="2")
    parser.add_argument("--parent-only", action="store_true")
    parser.add_argument("--seed", type=int, default=0, help="of the moments")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        suite = Path(name) / "suite.yaml"
        suite.write_text(SUITE)
        chosen = options.suite or str(suite)
        all_courses = courses(chosen, ("--seeds", options.seeds, "--workers", options.workers))
        shares = [len(range(k, options.kills, len(all_courses))) for k in range(len(all_courses))]
        for course, share in zip(all_courses, shares, strict=True):
            began = time.monotonic()
            tally = survive(
                course, Path(name), share, parent_only=options.parent_only, seed=options.seed
            )
            killed = "the command alone" if options.parent_only else "the whole process group"
            print(
                f"{course.name}: {tally.kills} kills of {killed}; {tally.finished} courses reached"
                f" their end, each equal to the unbroken one and with nothing left behind."
                f" At the kill: {dict(tally.states)}. {time.monotonic() - began:.0f} s.",
                flush=True,
            )


if __name__ == "__main__":
    main()
