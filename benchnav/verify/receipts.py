"""Which runs were verified on this machine."""

from collections.abc import Callable, Sequence

from benchnav.errors import StoreError
from benchnav.runner.execute.progress import Progress
from benchnav.store.packs.pack import content
from benchnav.store.runs.pinned_run import pinned, pinned_digest
from benchnav.store.runs.receipt import any_receipts, drop_receipt, has_receipt, keep_receipt
from benchnav.store.runs.run_folder import RunFolder
from benchnav.text.plural import counted
from benchnav.verify.finding import Report
from benchnav.verify.verify import verify

Notify = Callable[[str], None]


def with_receipts(
    folders: Sequence[RunFolder], now: bool, progress: Progress, notify: Notify
) -> tuple[list[RunFolder], list[bool]]:
    """Return the runs, and for each whether its present content was verified on this machine.

    The receipts of this machine decide, not the run itself. Where there are receipts, the runs
    are pinned, so that a later change is noticed.

    Args:
        folders: the runs.
        now: verify the runs that have no receipt.
        progress: counts the episodes that are verified now.
        notify: receives messages.
    """
    if not now and not any_receipts():
        return list(folders), [False] * len(folders)
    runs = [pinned(folder) for folder in folders]
    return runs, [_is_verified(run, now, progress, notify) for run in runs]


def write_receipt(folder: RunFolder, report: Report, notify: Notify) -> None:
    """Record on this machine whether the content that was verified is clean."""
    try:
        if report.clean:
            content(folder)  # refuses links and files that are no part of a run
            keep_receipt(report.content, report.unknown)
        else:
            drop_receipt(report.content)
    except (OSError, StoreError, KeyError, TypeError, AttributeError) as error:
        notify(f"No receipt is written, so leaderboards will not show the mark: {error}")


def _is_verified(folder: RunFolder, now: bool, progress: Progress, notify: Notify) -> bool:
    try:
        known = has_receipt(pinned_digest(folder))
        return known or (now and _verify(folder, progress, notify))
    except StoreError as error:
        notify(f"{folder.shown} is not verified: {error}")
        return False


def _verify(folder: RunFolder, progress: Progress, notify: Notify) -> bool:
    notify(f"verifying {folder.shown}")
    report = verify(folder, progress=progress)
    write_receipt(folder, report, notify)
    if not report.clean:
        notify(
            f"{folder.shown} is NOT verified: {counted(len(report.findings), 'finding')}"
            f" ('benchnav verify {folder.shown}' names them)"
        )
    return report.clean
