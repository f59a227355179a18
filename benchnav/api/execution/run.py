"""Run a suite into a run folder: what `benchnav.run` and the command do.

This module imports little, so that the fork server starts before the imports of this process.
"""

from __future__ import annotations

from datetime import datetime
from functools import partial
from os import PathLike
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

from benchnav.api.output.messages import message, silent
from benchnav.errors import UsageError, did_you_mean
from benchnav.processes.fork_server import fork_server
from benchnav.processes.main_module import stop_import_of_main
from benchnav.text.plural import counted

if TYPE_CHECKING:
    from collections.abc import Iterable

    from benchnav.api.execution.navigators import Navigators
    from benchnav.api.execution.suite_source import SuiteLike
    from benchnav.api.records.run import Run
    from benchnav.api.records.scenario import Scenario
    from benchnav.runner.plan.shard import Shard
    from benchnav.runner.plan.suite import Suite
    from benchnav.runner.run import Executor, Summary

EXECUTORS = ("local", "ray")


def run(
    suite: SuiteLike,
    *,
    navigators: Navigators | None = None,
    scenarios: str | Scenario | Iterable[str | Scenario | PathLike[str]] | None = None,
    tracks: str | Iterable[str] | None = None,
    perception: str | Iterable[str] | None = None,
    seeds: int | str | range | None = None,
    out: str | PathLike[str] | None = None,
    workers: int | None = None,
    timeout: float | None = None,
    memory: float | None = None,
    executor: str = "local",
    address: str | None = None,
    shard: str | None = None,
    salt: str | None = None,
    isolate: bool = False,
    again: bool = False,
    quiet: bool = False,
    debug: bool = False,
) -> Run:
    """Run scenarios × tracks × perceptions × navigators × seeds, and return the run.

    A run that stopped early continues with the same call and the same ``out``.

    Args:
        suite: the name or file of a suite or scenario, a `Scenario`, or a suite as a dict.
        navigators: instead of the suite's own: names, ``{"type": name, …parameters}``,
            classes, instances or functions; or ``{label: navigator}``.
        scenarios: instead of the suite's own: names, files or `Scenario` objects.
        tracks: instead of the suite's own: known, stale, partial, unknown.
        perception: instead of the suite's own: exact, noisy.
        seeds: N for the seeds 0 … N-1, or a range, or "A:B".
        out: the run folder; None: a new one in ``runs``.
        workers: processes; None: one per core; 0: this process, where nothing is guarded.
        timeout: [s] that a call of a navigator may last; None: 300, or as in ``out``.
        memory: [GB] that a worker may hold; None: 4, or as in ``out``.
        executor: "local", or "ray" (an extra) for a Ray cluster.
        address: of the Ray cluster; None: this machine.
        shard: "I/N" for only this share of the episodes; `benchnav.merge` joins them.
        salt: of the navigators' randomness, in hexadecimal digits; None: a new one.
        isolate: put every navigator in a process of its own that receives messages.
        again: run again the episodes that older code made.
        quiet: print no progress and no summary.
        debug: print the tracebacks of exceptions in plugins.

    Raises BenchnavError for a mistake in the call, and where the run cannot be made.
    """
    stop_import_of_main()
    if workers != 0:
        fork_server().prepare()  # loads kernels while this process imports and reads the suite
    from benchnav.api.execution.navigators import navigator_specs
    from benchnav.api.execution.suite_source import scenario_name, several, suite_source
    from benchnav.api.records.run import open_run
    from benchnav.runner.plan.suite import Selection, load_suite

    selection = Selection(
        tuple(map(scenario_name, several(scenarios))), tuple(several(tracks)),
        navigator_specs(navigators), seeds_text(seeds), salt or "", isolate,
        tuple(several(perception)),
    )  # fmt: skip
    running, share = _executor(executor, address, workers), _shard(shard)
    found = load_suite(suite_source(suite), selection, timeout=timeout)
    folder = Path(out) if out is not None else _new_folder(found)
    say = silent if quiet else message
    say(_announcement(found, folder))
    options = {
        "workers": workers, "timeout": timeout, "memory": memory, "executor": running,
        "shard": share, "again": again,
    }  # fmt: skip
    summary = _execute(found, folder, options, quiet, debug)
    return open_run(folder, summary)


def _execute(
    suite: Suite, folder: Path, options: dict[str, Any], quiet: bool, debug: bool
) -> Summary:
    from benchnav.runner.conclusion import conclusion, kept_for_now, tracebacks
    from benchnav.runner.execute.progress import progress
    from benchnav.runner.run import Summary, run_suite

    summary, began = Summary(), perf_counter()
    try:
        run_suite(suite, folder, progress=progress(quiet), summary=summary, **options)
    except KeyboardInterrupt as stopped:
        stopped.add_note(f"{summary.stored} of {counted(summary.total, 'episode')} stored.")
        stopped.add_note(f"To continue, run the same suite with the folder {folder} as out.")
        if kept := kept_for_now(summary):
            stopped.add_note(kept)
        raise
    if not quiet:
        message(conclusion(summary, perf_counter() - began))
    if debug:
        message(tracebacks(summary))
    return summary


def seeds_text(seeds: int | str | range | None) -> str:
    """Return seeds as the command line takes them; "" for None.

    Raises UsageError for a range with a step.
    """
    if isinstance(seeds, range):
        if seeds.step != 1:
            raise UsageError(f"The seeds must be a range without a step. Got {seeds} instead.")
        return f"{seeds.start}:{seeds.stop}"
    return "" if seeds is None else str(seeds)


def _new_folder(suite: Suite) -> Path:
    return Path("runs") / f"{suite.name}-{datetime.now():%Y%m%d-%H%M%S}"


def _executor(name: str, address: str | None, workers: int | None) -> Executor | None:
    if name not in EXECUTORS:
        raise UsageError(
            f"The executor must be one of {', '.join(EXECUTORS)}. Got {name!r} instead."
            f"{did_you_mean(name, EXECUTORS)}"
        )
    if name == "local":
        if address is not None:
            raise UsageError(
                "An address belongs to a Ray cluster. Got one without the executor 'ray'."
            )
        return None
    if workers == 0:
        raise UsageError("The executor 'ray' needs workers. Got 0 workers.")
    from benchnav.runner.ray.ray_executor import execute_on_ray

    return partial(execute_on_ray, address=address or "")


def _shard(text: str | None) -> Shard | None:
    from benchnav.runner.plan.shard import Shard

    try:
        return None if text is None else Shard.parse(text)
    except ValueError as error:
        raise UsageError(f"The shard {error}.") from None


def _announcement(suite: Suite, folder: Path) -> str:
    from benchnav.scenario.condition import EXACT

    sizes = (
        (len(suite.scenarios), "scenario"), (len(suite.tracks), "track"),
        *([] if suite.perceptions == (EXACT,) else [(len(suite.perceptions), "perception")]),
        (len(suite.contestants), "navigator"), (len(suite.seeds), "seed"),
    )  # fmt: skip
    product = " × ".join(counted(n, what) for n, what in sizes)
    some = f" (in {len(suite.blocks)} blocks of cells)" if suite.blocks else ""
    return f"{suite.name}@{suite.version}: {product}{some}, into {folder}"
