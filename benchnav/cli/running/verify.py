"""`benchnav verify`: is what a run says true?"""

from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated

import typer

from benchnav.cli.console import columns, put, say
from benchnav.text.plural import counted
from benchnav.text.visible import visible

if TYPE_CHECKING:
    from benchnav.store.runs.run_folder import RunFolder
    from benchnav.verify.finding import Report

SHOWN = 40  # findings


def verify(
    run: Annotated[Path, typer.Argument(metavar="RUN", help="Run folder or pack.")],
    twin: Annotated[
        int,
        typer.Option(
            metavar="N", min=0, help="Episodes that the slow twin of the kernels replays as well."
        ),
    ] = 20,
    referee: Annotated[
        str | None,
        typer.Option(help="Who judges every contact a second time: fcl."),
    ] = None,
    rerun: Annotated[
        bool, typer.Option("--rerun", help="Run the navigators again where they are deterministic.")
    ] = False,
    workers: Annotated[
        int | None,
        typer.Option(metavar="N", min=0, max=1024, help="Processes. [default: one per core]"),
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print the findings as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Say nothing but errors.")] = False,
) -> None:
    """Check a run without its navigators.

    Draws its worlds again, re-simulates its commands, measures its metrics, and names every
    stored number that does not agree. Exit status 1 where there are any.
    """
    from benchnav.errors import UsageError
    from benchnav.runner.execute.progress import progress
    from benchnav.store.packs.unpack import opened
    from benchnav.verify.verify import Wanted
    from benchnav.verify.verify import verify as check

    if referee not in (None, "fcl"):
        raise UsageError(f"--referee must be fcl. Got {referee!r} instead.")
    wanted = Wanted(twin, referee is not None, rerun)
    with opened(run) as folder:
        began = perf_counter()
        report = check(folder, wanted, workers=workers, progress=progress(quiet))
        seconds = perf_counter() - began
        keep(folder, report)
    put(as_json(run, report, seconds) if json else as_text(run, report, seconds))
    if not report.clean:
        raise typer.Exit(1)


def keep(folder: "RunFolder", report: "Report") -> None:
    """Remember on this machine that the content that was verified is, or is not."""
    from benchnav.errors import StoreError
    from benchnav.store.packs.pack import content
    from benchnav.store.runs.receipt import drop_receipt, keep_receipt

    try:
        if report.clean:
            content(folder)  # refuses links and what no run holds
            keep_receipt(report.content, report.unknown)
        else:
            drop_receipt(report.content)
    except (OSError, StoreError, KeyError, TypeError, AttributeError) as error:
        say(f"No receipt is kept, so that leaderboards will not know: {error}")


def as_json(run: Path, report: "Report", seconds: float) -> str:
    """For other machines."""
    from dataclasses import asdict
    from json import dumps

    said = {
        "run": str(run), "verified": report.clean, "seconds": round(seconds, 3),
        "findings": [asdict(finding) for finding in report.findings],
        "checked": dict(sorted(report.counts.items())), "not_checked": report.unchecked,
        "versions": report.versions, "sources": report.sources, "caveats": report.caveats,
    }  # fmt: skip
    return dumps(said, indent=1)


def as_text(run: Path, report: "Report", seconds: float) -> str:
    """For people: the verdict, findings, what was checked and what was not."""
    count = len(report.findings)
    verdict = "verified" if report.clean else f"NOT verified: {counted(count, 'finding')}"
    lines = [f"{run}: {verdict}, in {seconds:.1f} s"]
    if count:
        few = report.few(SHOWN)
        lines += ["", columns([(f.kind, visible(f.where), visible(f.what)) for f in few])]
        if count > len(few):
            lines.append(f"… and {count - len(few)} more (--json has all)")
        lines.append("")
    lines += [f"  checked      {visible(text)}" for text in report.checked]
    lines += [f"  not checked  {visible(text)}" for text in report.unchecked]
    lines += [f"  source       {visible(text)}" for text in report.sources]
    lines += [f"  note         {visible(text)}" for text in (*report.versions, *report.caveats)]
    return "\n".join(lines)
