"""Receipts: which runs were verified on this machine, by their content.

A receipt lies in the user's own folder and not in the run, because the author of a run could
write a false one. It is valid for exactly this content, and for this
state of the code.
"""

import json
from collections.abc import Iterable
from datetime import UTC, datetime
from pathlib import Path

from benchnav.kernels import kernels_name
from benchnav.plugins import METRICS
from benchnav.store.runs.manifest import versions
from benchnav.system.user_folders import user_state


def receipts_folder() -> Path:
    """Return the folder of receipts: ``$XDG_STATE_HOME/benchnav/verified``.

    Raises OSError if this user has no such folder.
    """
    state = user_state()
    if state.path is None:
        raise PermissionError(state.reason)
    return state.path / "verified"


def any_receipts() -> bool:
    """Whether any run was verified on this machine."""
    try:
        return receipts_folder().is_dir()
    except OSError:
        return False


def keep_receipt(digest: str, unknown: Iterable[str]) -> None:
    """Record that a run with this content is verified, except for values of ``unknown`` metrics.

    Raises OSError if it cannot be written.
    """
    path = receipts_folder() / f"{digest}.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    receipt = {
        "content": digest, "code": _code(), "unknown": sorted(unknown),
        "when": datetime.now(UTC).isoformat(timespec="seconds"),
    }  # fmt: skip
    path.write_text(json.dumps(receipt, indent=1) + "\n", encoding="utf-8")


def drop_receipt(digest: str) -> None:
    """Remove the receipt of this content."""
    (receipts_folder() / f"{digest}.json").unlink(missing_ok=True)


def has_receipt(digest: str) -> bool:
    """Whether a run with this content was verified here, by this code and these metrics."""
    try:
        receipt = json.loads((receipts_folder() / f"{digest}.json").read_text(encoding="utf-8"))
        installed = set(METRICS.names()) & set(receipt["unknown"])
        return bool(receipt["content"] == digest and receipt["code"] == _code() and not installed)
    except (OSError, ValueError, KeyError, TypeError):
        return False


def verified_at(digest: str) -> str:
    """Return the time (ISO 8601) at which a run with this content was verified; "" if unknown."""
    try:
        receipt = json.loads((receipts_folder() / f"{digest}.json").read_text(encoding="utf-8"))
        return str(receipt["when"])
    except (OSError, ValueError, KeyError, TypeError):
        return ""


def _code() -> str:
    """Return the state of the code: the version, and the kernels that re-simulate."""
    return f"{versions().get('benchnav')} {kernels_name('benchnav')}"
