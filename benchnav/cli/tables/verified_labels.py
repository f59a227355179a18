"""Which runs of a leaderboard were verified on this machine."""

from collections.abc import Sequence

from benchnav.cli.console import say
from benchnav.errors import StoreError
from benchnav.store.runs.run_folder import RunFolder
from benchnav.text.plural import counted


def vouched(folders: Sequence[RunFolder], now: bool) -> tuple[list[RunFolder], list[bool]]:
    """The runs, and of each whether exactly what is read of it was verified here.

    What a run says of itself is not asked: a receipt that verifying left on this machine
    is, or with ``now`` the run itself. Where there may be receipts, the runs are pinned.
    """
    from benchnav.store.runs.pinned_run import pinned
    from benchnav.store.runs.receipt import any_receipts

    if not now and not any_receipts():
        return list(folders), [False] * len(folders)
    runs = [pinned(folder) for folder in folders]
    return runs, [_verified(run, now) for run in runs]


def _verified(folder: RunFolder, now: bool) -> bool:
    from benchnav.store.runs.pinned_run import pinned_digest
    from benchnav.store.runs.receipt import has_receipt

    try:
        return has_receipt(pinned_digest(folder)) or (now and _verify(folder))
    except StoreError as error:
        say(f"{folder.shown} is not verified: {error}")
        return False


def _verify(folder: RunFolder) -> bool:
    from benchnav.cli.running.verify import keep
    from benchnav.runner.execute.progress import progress
    from benchnav.verify.verify import verify

    say(f"verifying {folder.shown}")
    report = verify(folder, progress=progress(False))
    keep(folder, report)
    if not report.clean:
        say(
            f"{folder.shown} is NOT verified: {counted(len(report.findings), 'finding')}"
            f" ('benchnav verify {folder.shown}' names them)"
        )
    return report.clean
