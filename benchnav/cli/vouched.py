"""Which entries of a leaderboard were verified on this machine."""

from collections.abc import Sequence

from benchnav.cli.console import say
from benchnav.errors import StoreError
from benchnav.plural import counted
from benchnav.store.run_folder import RunFolder


def vouched(folders: Sequence[RunFolder], now: bool) -> set[str]:
    """The labels all of whose runs, of those given, were verified here.

    What a run says of itself is not asked: a receipt that verifying left on this machine
    is, or with ``now`` the run itself.
    """
    labels: dict[str, bool] = {}
    for folder in folders:
        good = _verified(folder, now)
        for entry in folder.manifest.suite.get("navigators", ()):
            label = str(entry["label"])
            labels[label] = labels.get(label, True) and good
    return {label for label, good in labels.items() if good}


def _verified(folder: RunFolder, now: bool) -> bool:
    from benchnav.store.pack import content_digest
    from benchnav.store.receipt import any_receipts, has_receipt

    if not now and not any_receipts():
        return False
    try:
        return has_receipt(content_digest(folder)) or (now and _verify(folder))
    except StoreError as error:
        say(f"{folder.shown} is not verified: {error}")
        return False


def _verify(folder: RunFolder) -> bool:
    from benchnav.cli.verify import keep
    from benchnav.runner.progress import progress
    from benchnav.runner.verify.verify import verify

    say(f"verifying {folder.shown}")
    report = verify(folder, progress=progress(False))
    keep(folder, report)
    if not report.clean:
        say(
            f"{folder.shown} is NOT verified: {counted(len(report.findings), 'finding')}"
            f" ('benchnav verify {folder.shown}' names them)"
        )
    return report.clean
