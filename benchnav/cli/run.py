"""`benchnav run`: execute a suite."""

from collections import Counter
from datetime import datetime
from enum import StrEnum
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated

import typer

from benchnav.cli.console import one_of, put, say
from benchnav.errors import UsageError
from benchnav.plural import counted

if TYPE_CHECKING:
    from benchnav.runner.run import Executor, Summary
    from benchnav.runner.shard import Shard
    from benchnav.runner.suite import Suite


class Where(StrEnum):
    """Who runs the tasks."""

    LOCAL = "local"
    RAY = "ray"


def run(
    suite: Annotated[
        str, typer.Argument(metavar="SUITE", help="Name of a suite that ships, or a file.")
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            help="Run folder; the same suite goes on where it stopped. [default: new]",
        ),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(metavar="N", min=0, max=1024, help="Processes. [default: one per core]"),
    ] = None,
    timeout: Annotated[
        float | None,
        typer.Option(
            metavar="S",
            help="A call of a navigator that lasts longer fails its episode. [default: 300]",
        ),
    ] = None,
    memory: Annotated[
        float | None,
        typer.Option(
            metavar="GB", help="So does one whose process holds more memory. [default: 4]"
        ),
    ] = None,
    executor: Annotated[
        str, typer.Option(help="local, or ray (extra): a Ray cluster.")
    ] = Where.LOCAL.value,
    address: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            help="Of the Ray cluster: auto, host:port, ray://host:port. [default: this machine]",
        ),
    ] = None,
    shard: Annotated[
        str | None,
        typer.Option(
            metavar="I/N", help="Only this share of the episodes; `benchnav merge` joins them."
        ),
    ] = None,
    seeds: Annotated[
        str | None, typer.Option(metavar="N|A:B", help="Seeds 0 … N-1, or A … B-1.")
    ] = None,
    navigator: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="Only this one of the suite, or any other, also '{type: name, …}'. Repeatable.",
        ),
    ] = None,
    scenario: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="Instead of the suite's: name or file. Repeatable."),
    ] = None,
    track: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="Instead of the suite's. Repeatable.")
    ] = None,
    salt: Annotated[
        str | None,
        typer.Option(
            metavar="HEX",
            help="Of navigators' randomness, to repeat a run: its manifest has it. [default: new]",
        ),
    ] = None,
    isolate: Annotated[
        bool,
        typer.Option(
            "--isolate", help="Every navigator in a process of its own that is sent messages."
        ),
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Say nothing but errors.")] = False,
) -> None:
    """Execute a suite into a run folder.

    Scenarios × tracks × navigators × seeds. Prints the run folder on stdout;
    `benchnav leaderboard` makes the table from it.
    """
    from benchnav.runner.progress import progress
    from benchnav.runner.run import Summary, run_suite
    from benchnav.runner.suite import Selection, load_suite

    chosen = Selection(
        tuple(scenario or ()), tuple(track or ()), tuple(navigator or ()), seeds or "", salt or "",
        isolate,
    )  # fmt: skip
    running = _executor(one_of(Where, "--executor", executor), address, workers)
    share = _shard(shard)
    asked = load_suite(suite, chosen)
    folder = (
        out if out is not None else Path("runs") / f"{asked.name}-{datetime.now():%Y%m%d-%H%M%S}"
    )
    if not quiet:
        say(_announce(asked, folder))
    summary, began = Summary(), perf_counter()
    try:
        run_suite(
            asked, folder, workers=workers, timeout=timeout, memory=memory, executor=running,
            shard=share, progress=progress(quiet), summary=summary,
        )  # fmt: skip
    except KeyboardInterrupt:
        say(
            f"Interrupted: {summary.stored} of {counted(summary.total, 'episode')} stored."
            f" The same command with --out {folder} goes on from there."
        )
        raise
    if not quiet:
        say(_conclude(summary, perf_counter() - began))
        say(f"The table: benchnav leaderboard {folder}")
    put(str(folder))


def _executor(where: Where, address: str | None, workers: int | None) -> "Executor | None":
    if where is Where.LOCAL:
        if address is not None:
            raise UsageError(
                "--address must be that of a Ray cluster. Got it without --executor ray."
            )
        return None
    if workers == 0:
        raise UsageError("--executor ray must have workers. Got --workers 0, which has none.")
    from benchnav.runner.ray_executor import execute_on_ray

    return partial(execute_on_ray, address=address or "")


def _shard(text: str | None) -> "Shard | None":
    from benchnav.runner.shard import Shard

    try:
        return None if text is None else Shard.parse(text)
    except ValueError as error:
        raise UsageError(f"--shard {error}.") from None


def _announce(suite: "Suite", folder: Path) -> str:
    sizes = (
        (len(suite.scenarios), "scenario"), (len(suite.tracks), "track"),
        (len(suite.entries), "navigator"), (len(suite.seeds), "seed"),
    )  # fmt: skip
    product = " × ".join(counted(n, what) for n, what in sizes)
    some = f" (in {len(suite.blocks)} blocks of cells)" if suite.blocks else ""
    return f"{suite.name}@{suite.version}: {product}{some}, into {folder}"


def _conclude(summary: "Summary", seconds: float) -> str:
    fresh = summary.stored - summary.found
    lines = [f"{counted(summary.stored, 'episode')} stored, {fresh} of them run in {seconds:.1f} s"]
    if fresh and seconds > 0:
        lines[0] += f" ({fresh / seconds:.3g} a second)"
    if summary.redraws:
        lines.append(
            f"drawn again, because they were not solvable: {counted(summary.redraws, 'world')}"
        )
    reasons = Counter[tuple[str, str]]()
    for cell, reason in summary.not_applicable:
        reasons[cell.entry.label, f"{reason} ({cell.track})"] += 1
    lines += [
        f"n/a: {who} {why}, {counted(n, 'cell')}" for (who, why), n in sorted(reasons.items())
    ]
    lines += [
        f"failed: {who} in {counted(n, 'episode')}: {why}"
        for (who, why), n in summary.failures.most_common(10)
    ]
    if len(summary.failures) > 10:
        lines.append(f"… and for {counted(len(summary.failures) - 10, 'more reason')}")
    lines += [
        f"the metric {metric} failed for {counted(n, 'value')}: {why}"
        for (metric, why), n in summary.missing.most_common(5)
    ]
    lines += [
        f"warning: {who}: the leader of {team!r} succeeded in no rehearsal in"
        f" {counted(n, 'world')} of {scenario}"
        for (who, scenario, team), n in summary.unled.most_common(10)
    ]
    lines += [
        f"{who} tells of {counted(n, 'world')} of {scenario}: {text}"
        for (who, scenario, text), n in summary.remarks.most_common(5)
    ]
    if len(summary.remarks) > 5:
        lines.append(
            f"… and of {counted(len(summary.remarks) - 5, 'more thing')}; episodes keep them all"
        )
    return "\n".join(lines)
