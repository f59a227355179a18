"""Tampers with everything that a run holds, one thing at a time, and asks what notices.

The attacker knows the format: digests, measured values, hashes, cell keys, seals and
checksums are made to fit whatever was changed. What is tried comes from the schemas and from
the files of an honest run, so a new column or key is tried as soon as there is one.
"""

import json
import re
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from benchnav.errors import BenchnavError
from benchnav.metrics.measure import all_metrics
from benchnav.runner.execute.measurement import measured
from benchnav.runner.plan.suite import load_suite
from benchnav.runner.run import run_suite
from benchnav.store.parts.digest import digest
from benchnav.store.parts.episodes import EPISODES, from_table, to_table
from benchnav.store.parts.part import EPISODES_FILE, REHEARSALS_FILE, RESULTS_FILE, SEAL
from benchnav.store.parts.results import RESULTS
from benchnav.store.runs import checked_json
from benchnav.store.runs.manifest import MANIFEST
from benchnav.store.runs.pinned_run import pinned
from benchnav.store.runs.run_folder import RunFolder
from benchnav.verify.examination import examine
from benchnav.verify.finding import Report
from benchnav.verify.rerun import rerun
from benchnav.verify.verify import Wanted, rebuilt, tasks_of
from tests.conformance.refit import refit_manifest, refit_seal, write_manifest

SCENARIO = """
name: attacked/{name}
title: Discs that change places
bounds: [-3, -3, 3, 3]
{more}
teams:
  - name: pair
    count: 2
    radius: 0.2
    max_speed: 1
    start: {{type: circle, radius: 2}}
    goal: {{type: antipodal}}
clock: {{dt: 0.2, substeps: 2, horizon: 2.4}}
"""
OBSTACLE = "static: [{shape: {type: disc, radius: 0.3}, region: {type: anywhere, margin: 1}}]"
SUITE = """
name: attacked
scenarios: [first.yaml, second.yaml]
tracks: [known]
navigators:
  - {type: guided-crowd, label: guided, rehearsal: 1, leader: straight-line}
  - {type: "attacked_navigator:Fails", label: fails}
blocks:
  - {scenarios: [first.yaml]}
  - {scenarios: [second.yaml], navigators: [fails]}
seeds: 2
"""
NAVIGATOR = '''
import numpy as np
from benchnav.navigation.navigator import Navigator

class Fails(Navigator):
    """Stands, and raises after half a second."""
    uses_map = False
    def reset(self, briefings, rows): pass
    def act(self, observation):
        if observation.time.max() > 0.5:
            raise ValueError("lost")
        return np.zeros((*observation.active.shape, 2))
    def remarks(self, row):
        return ("stands",)
'''

ADDED = {
    "shard": "1/2", "unguarded": ["fails"],
    "suite.navigators[].mode": "isolated", "suite.navigators[].uses_map": False,
    "suite.navigators[].fingerprint": "0" * 16, "cells[].seeds": [[0, 2]],
    "cells[].also": ["stale"],
    "suite.navigators[].training": {"decisions": 5, "seconds": 1.0}, "suite.undisturbed": True,
}  # fmt: skip
"""Keys of a manifest that an honest run need not have, and what an attacker may add."""

BY_DESIGN = {
    "episodes.decision_seconds, episodes.planning_seconds, episodes.latency_seconds, *.batch": (
        "timings of the author's machine; that values follow from them is checked"
    ),
    "*.memory_bytes": "memory of the author's machine; likewise",
    "episodes.traceback, rehearsals.traceback": "its lines are those of the author's libraries",
    "manifest.suite.name, manifest.suite.version": (
        "what the author calls the suite; a name that ships is compared with the installed suite"
    ),
    "*.config.title, *.config.description": "texts for people; nothing follows from them",
    "manifest.suite.navigators[].config.*": (
        "a parameter that changes no command of the run. --rerun finds any other change, or"
        " reports that it did not run the navigator"
    ),
    "manifest.suite.navigators[].source, manifest.suite.navigators[].fingerprint,"
    " manifest.suite.navigators[].mode": (
        "--rerun names the navigator as another one than the installed, and does not run it"
    ),
    "manifest.suite.navigators[].leader, manifest.suite.navigators[].leader.*": (
        "likewise; its label and its use of the map change nothing"
    ),
    "manifest.sources, manifest.sources.*": "verification names a source that is not installed",
    "manifest.limits, manifest.limits.*": (
        "limits depend on the author's machine; verification shows them"
    ),
    "manifest.shard": "a missing key means that the run is no shard; any other change is found",
    "manifest.unguarded": (
        "an author may remove the note that a navigator ran unguarded; only --rerun checks its"
        " commands"
    ),
    "manifest.versions.*, manifest.platform, manifest.created, manifest.provenance,"
    " manifest.provenance.*": (
        "the author's machine, code, command and time; verification shows them"
    ),
}
"""What verification does not find → why. docs/verification.md holds it word for word."""


def by_design() -> str:
    """Return the list as it stands in the documents."""
    lines = []
    for names, reason in BY_DESIGN.items():
        lines.append(f"- {', '.join(f'`{name}`' for name in names.split(', '))}: {reason}.")
    return "\n".join(lines)


def is_by_design(name: str) -> list[str]:
    """Return the patterns of `BY_DESIGN` that cover what was not found."""
    patterns = [pattern for names in BY_DESIGN for pattern in names.split(", ")]
    return [p for p in patterns if re.fullmatch(re.escape(p).replace(r"\*", ".*"), name)]


@dataclass
class Outcome:
    """What was tried and, of what was not found by verification, what noticed it."""

    tried: list[str] = field(default_factory=list)
    found: dict[str, str] = field(default_factory=dict)  # → "verify", "--rerun"
    missed: dict[str, str] = field(default_factory=dict)  # → "named" beside the verdict, or ""


def honest_run(folder: Path) -> Path:
    """Return a run of two small scenarios and two navigators: rehearsals, failures, remarks."""
    (folder / "attacked_navigator.py").write_text(NAVIGATOR)
    sys.path.insert(0, str(folder))
    for name, more in (("first", OBSTACLE), ("second", "")):
        (folder / f"{name}.yaml").write_text(SCENARIO.format(name=name, more=more))
    (folder / "attacked.yaml").write_text(SUITE)
    run_suite(load_suite(str(folder / "attacked.yaml")), folder / "run", workers=0)
    return folder / "run"


def attack(run: Path, every: int = 1) -> Outcome:
    """Try all attacks, or one of ``every``, on ``run``, which is the same afterwards."""
    outcome = Outcome()
    honest = {again: _noticed(run, again) for again in (False, True)}
    for name, change in (*_tables(run), *_manifest(run), *_seals(run))[::every]:
        try:
            with _kept(run) as unchanged:
                if not change() or unchanged():
                    continue
                answer = _answer(run, honest)
        except Exception as error:
            error.add_note(f"while {name} was attacked")
            raise
        if name not in outcome.tried:
            outcome.tried.append(name)
        if answer in ("verify", "--rerun"):
            if outcome.found.get(name) != "--rerun":
                outcome.found[name] = answer
        elif outcome.missed.get(name) != "":
            outcome.missed[name] = answer
    outcome.found = {k: v for k, v in outcome.found.items() if k not in outcome.missed}
    return outcome


def _answer(run: Path, honest: dict[bool, list[str]]) -> str:
    named = ""
    for again, name in ((False, "verify"), (True, "--rerun")):
        noticed = _noticed(run, again)
        if noticed is None:
            return name
        if noticed != honest[again]:
            named = "named"
    return named


def _noticed(run: Path, again: bool) -> list[str] | None:
    """What stands beside the verdict; None where the run is not verified, or not read at all.

    As `verify` does it, part by part, but no further than to the first finding.
    """
    report, wanted = Report(), Wanted(0, rerun=again)
    with TemporaryDirectory() as root:
        try:
            folder = pinned(RunFolder.open(run))
            suite = rebuilt(folder, Path(root), report)
            tasks = tasks_of(folder, suite, wanted, report) if suite else []
            for task in tasks:
                if report.clean:
                    report.add(examine(task))
            if again and suite and report.clean:
                checks = [task.check for task in tasks]
                rerun(folder, suite.jobs, checks, Path(root) / "rerun", report, workers=0)
        except BenchnavError:
            return None
    lines = [*report.checked, *report.unchecked, *report.sources, *report.versions]
    return [*lines, *report.caveats] if report.clean else None


@contextmanager
def _kept(run: Path) -> Iterator[Callable[[], bool]]:
    """Put every file back afterwards. Yields what tells whether nothing was changed until now."""

    def held() -> dict[Path, bytes]:
        return {path: path.read_bytes() for path in run.rglob("*") if path.is_file()}

    before = held()
    try:
        yield lambda: held() == before
    finally:
        for path in [path for path in run.rglob("*") if path.is_file() and path not in before]:
            path.unlink()
        for path, content in before.items():
            path.parent.mkdir(exist_ok=True)
            if not path.exists() or path.read_bytes() != content:
                path.write_bytes(content)
        for folder in run.glob("parts/*"):
            if not any(folder.iterdir()):
                folder.rmdir()


Attack = tuple[str, Callable[[], bool]]
"""What is attacked, and what does it: False where there was nothing to change."""


def _tables(run: Path) -> Iterator[Attack]:
    """Every column of every table, in a part that has a value there."""
    for suffix, schema in (
        (EPISODES_FILE, EPISODES), (REHEARSALS_FILE, EPISODES), (RESULTS_FILE, RESULTS)
    ):  # fmt: skip
        paths = sorted(run.glob(f"parts/attacked-first*/*{suffix}"))
        tables = {path: _read(path, schema) for path in paths}
        for column in schema.names:
            path, row = _valued(tables, column)
            for variant in range(2):

                def change(
                    path=path, schema=schema, column=column, row=row, variant=variant
                ) -> bool:
                    return _change_column(path, schema, column, row, variant)

                yield f"{suffix.split('.')[1]}.{column}", change


def _valued(tables: dict[Path, pa.Table], column: str) -> tuple[Path, int]:
    """A file and row in which a column says something; the first where it says nothing at all."""
    for path, table in tables.items():
        for row, value in reversed(list(enumerate(table[column].to_pylist()))):
            if value not in (None, [], "", 0):
                return path, row
    return next(iter(tables)), 0


def _read(path: Path, schema: pa.Schema) -> pa.Table:
    """A table as it is stored, with the column that parts of exact perception leave out."""
    table = pq.read_table(path)
    for name in schema.names:
        if name not in table.column_names:
            table = table.append_column(schema.field(name), pa.array(["exact"] * len(table)))
    return table


def _change_column(path: Path, schema: pa.Schema, column: str, row: int, variant: int) -> bool:
    table = _read(path, schema)
    values = table[column].to_pylist()
    kind = table.schema.field(column).type
    options = ["noisy"] if column == "perception" else variants(values[row], kind)
    if variant >= len(options):
        return False
    values[row] = options[variant]
    place = table.column_names.index(column)
    pq.write_table(table.set_column(place, column, pa.array(values, kind)), path)
    stem = str(path.parent / path.name.partition(".")[0])
    if RESULTS_FILE not in path.name:
        _refit_episodes(path, column)
        _refit_results(stem)
    refit_seal(stem)
    return True


def _refit_episodes(path: Path, column: str) -> None:
    """Give episodes the digest of what they hold, where they can be decoded at all."""
    if column == "digest":
        return
    try:
        episodes = [replace(e, digest=digest(e)) for e in from_table(pq.read_table(path))]
        pq.write_table(to_table(episodes), path)
    except (ValueError, TypeError, KeyError, IndexError, AttributeError):
        return


def _refit_results(stem: str) -> None:
    """Measure the changed episodes, so that values follow from them."""
    try:
        episodes = list(from_table(pq.read_table(stem + EPISODES_FILE)))
        pq.write_table(measured(episodes, all_metrics()), stem + RESULTS_FILE)
    except Exception:  # what cannot be measured keeps its values
        return


def variants(value: Any, kind: Any = None) -> list[Any]:
    """Other values of the same type: a little and a lot, and none at all."""
    if isinstance(value, bool):
        return [not value]
    if isinstance(value, int):
        return [value + 1, 0] if value else [1]
    if isinstance(value, float) and value != value:
        return [0.5]
    if isinstance(value, float):
        return [1.1 * value + 0.01, 0.0] if value else [0.5]
    if isinstance(value, str):
        if numbers := list(re.finditer(r"(?<=[\[,:])-?\d+\.\d+", value)):
            middle = numbers[len(numbers) // 2]
            start, end = middle.span()
            return [f"{value[:start]}{float(middle[0]) + 0.25!r}{value[end:]}", ""]
        return [value + "x", ""] if value else ["act raised ValueError: x"]
    if isinstance(value, list | tuple):
        if not value:
            return [["x"]] if pa.types.is_string(getattr(kind, "value_type", pa.null())) else []
        middle = len(value) // 2
        first = [*value[:middle], variants(value[middle])[0], *value[middle + 1 :]]
        return [first, list(value[:-1])]
    if value is None and kind is not None:
        return [_some(kind)]
    return [0]


def _some(kind: pa.DataType) -> Any:
    if pa.types.is_large_list(kind) or pa.types.is_list(kind):
        return [_some(kind.value_type)]
    return "x" if pa.types.is_string(kind) else 1


def _manifest(run: Path) -> Iterator[Attack]:
    """Every key of the manifest: changed, removed, and added where it need not be there."""
    content = json.loads((run / MANIFEST).read_text())
    tried: set[str] = set()
    for path in (*_paths(content), *_lacking(content)):
        name = _generic(path)
        if name in ("sha256", "suite_hash") or name in tried:
            continue
        tried.add(name)
        own = name.startswith("suite.scenarios[].config.")  # one hash covers them all
        for variant in range(2 if own else 3):

            def change(path=path, name=name, variant=variant) -> bool:
                return _change_key(run, path, name, variant)

            yield f"manifest.{name}", change


def _paths(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    if path and isinstance(path[-1], str):
        yield path
    if isinstance(value, dict):
        for key, child in value.items():
            yield from _paths(child, (*path, key))
    elif isinstance(value, list):
        for place, child in enumerate(value):
            yield from _paths(child, (*path, place))


def _lacking(content: dict[str, Any]) -> Iterator[tuple[Any, ...]]:
    for name in ADDED:
        path: tuple[Any, ...] = ()
        for part in name.split("."):
            path = (*path, part.removesuffix("[]"), *([0] if part.endswith("[]") else []))
        yield path


def _generic(path: tuple[Any, ...]) -> str:
    text = ""
    for key in path:
        text += "[]" if isinstance(key, int) else f".{key}"
    return text.removeprefix(".")


def _change_key(run: Path, path: tuple[Any, ...], name: str, variant: int) -> bool:
    """Remove a key (0), or change it. What a scenario leaves out stands for its default."""
    content = json.loads((run / MANIFEST).read_text())
    place = content
    for key in path[:-1]:
        place = place[key]
    held = place.get(path[-1])
    if variant == 0:
        if path[-1] not in place or name.startswith("suite.scenarios[].config."):
            return False
        del place[path[-1]]
    else:
        options = [] if held is None or isinstance(held, dict) else variants(held)
        options = [ADDED[name]] if name in ADDED and held != ADDED[name] else options
        if variant > len(options):
            return False
        place[path[-1]] = options[variant - 1]
    wanted = json.loads(json.dumps(place.get(path[-1])))
    refit_manifest(run, content, attacked=name)
    place = content
    for key in path[:-1]:
        place = place.get(key, {}) if isinstance(key, str) else place[key]
    if place.get(path[-1]) != wanted:  # refitting made it what it was
        place[path[-1]] = wanted
        write_manifest(run, content)
    return True


def _seals(run: Path) -> Iterator[Attack]:
    """Every key of a seal, with a checksum that fits."""
    seal = next(run.glob(f"parts/*guided*/*{SEAL}"))
    content = json.loads(seal.read_text())
    del content["sha256"]
    for path in _paths(content):
        for variant in range(3):

            def change(path=path, variant=variant) -> bool:
                changed = json.loads(json.dumps(content))
                place = changed
                for key in path[:-1]:
                    place = place[key]
                options = [None] if isinstance(place[path[-1]], dict) else variants(place[path[-1]])
                if variant > len(options):
                    return False
                if variant == 0:
                    del place[path[-1]]
                else:
                    place[path[-1]] = options[variant - 1]
                seal.write_text(checked_json.dump(changed))
                return True

            yield f"seal.{_generic(path).lstrip('.')}", change
