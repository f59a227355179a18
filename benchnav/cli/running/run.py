"""`benchnav run`: execute a suite."""

from datetime import datetime
from enum import StrEnum
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated

import typer

from benchnav.cli.console import one_of, put, say
from benchnav.errors import UsageError
from benchnav.text.plural import counted

if TYPE_CHECKING:
    from benchnav.runner.plan.shard import Shard
    from benchnav.runner.plan.suite import Suite
    from benchnav.runner.run import Executor


class Where(StrEnum):
    """Who runs the tasks."""

    LOCAL = "local"
    RAY = "ray"


def run(
    suite: Annotated[
        str,
        typer.Argument(
            metavar="SUITE|SCENARIO", help="Name of a suite or scenario that ships, or a file."
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            help="Run folder; the same suite continues there, also with more seeds. [default: new]",
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
    again: Annotated[
        bool,
        typer.Option(
            "--again", help="Run again what older code made; it is kept until all is there."
        ),
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Say nothing but errors.")] = False,
    debug: Annotated[
        bool, typer.Option("--debug", help="Print the tracebacks of what plugins raised.")
    ] = False,
) -> None:
    """Execute a suite into a run folder.

    Scenarios × tracks × navigators × seeds. Prints the run folder on stdout;
    `benchnav leaderboard` makes the table from it.
    """
    from benchnav.processes.fork_server import fork_server

    if workers != 0:
        fork_server().prepare()  # while the suite is read
    from benchnav.cli.running.conclusion import conclusion, kept_for_now, tracebacks
    from benchnav.runner.execute.progress import progress
    from benchnav.runner.plan.suite import Selection, load_suite
    from benchnav.runner.run import Summary, run_suite

    chosen = Selection(
        tuple(scenario or ()), tuple(track or ()), tuple(navigator or ()), seeds or "", salt or "",
        isolate,
    )  # fmt: skip
    running = _executor(one_of(Where, "--executor", executor), address, workers)
    share = _shard(shard)
    asked = load_suite(suite, chosen, timeout=timeout)
    folder = (
        out if out is not None else Path("runs") / f"{asked.name}-{datetime.now():%Y%m%d-%H%M%S}"
    )
    if not quiet:
        say(_announce(asked, folder))
    summary, began = Summary(), perf_counter()
    try:
        run_suite(
            asked, folder, workers=workers, timeout=timeout, memory=memory, executor=running,
            shard=share, again=again, progress=progress(quiet), summary=summary,
        )  # fmt: skip
    except KeyboardInterrupt as stopped:
        stopped.add_note(f"{summary.stored} of {counted(summary.total, 'episode')} stored.")
        stopped.add_note(f"The same command with --out {folder} continues there.")
        if kept := kept_for_now(summary):
            stopped.add_note(kept)
        raise
    if not quiet:
        say(conclusion(summary, perf_counter() - began))
        say(f"The table: benchnav leaderboard {folder}")
    if debug:
        say(tracebacks(summary))
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
    from benchnav.runner.ray.ray_executor import execute_on_ray

    return partial(execute_on_ray, address=address or "")


def _shard(text: str | None) -> "Shard | None":
    from benchnav.runner.plan.shard import Shard

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
