"""Write the report of runs, and say what was written."""

from collections.abc import Sequence
from pathlib import Path

from benchnav.api.output.messages import message, silent
from benchnav.errors import UsageError
from benchnav.leaderboard.from_runs import stored_values
from benchnav.report.site import REPLAYS, write_report
from benchnav.runner.execute.progress import progress
from benchnav.store.runs.run_folder import RunFolder
from benchnav.text.plural import counted
from benchnav.verify.receipts import with_receipts


def write(
    folders: Sequence[RunFolder],
    out: Path,
    *,
    metrics: Sequence[str] | None,
    replays: int | None,
    verify: bool,
    quiet: bool,
) -> Path:
    """Write the report and return its first page."""
    say = silent if quiet else message
    most = REPLAYS if replays is None else replays
    if most < 0:
        raise UsageError(f"The number of replays must be 0 or more. Got {most} instead.")
    runs, verified = with_receipts(folders, verify, progress(quiet), say)
    written = write_report(
        runs, lambda: stored_values(runs, verified=verified, notify=say), out,
        metrics=metrics, replays=most,
    )  # fmt: skip
    say(
        f"{counted(written.pages, 'page')} and {counted(written.replays, 'replay')},"
        f" {written.bytes / 1e6:.1f} MB beside the shared JavaScript"
    )
    return written.index
