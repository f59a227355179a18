"""The user's own folders for the cache and for state.

They follow the XDG base directories. If these cannot be used (no home, an unknown user, another
user's home, a read-only disk), a private folder in the temporary folder takes their place. A
folder that another user can write is never used, as compiled code is loaded from it.
"""

import os
import stat
import tempfile
from dataclasses import dataclass
from pathlib import Path

_NAME = "benchnav"
_ROOT = 0  # this user may write everywhere


@dataclass(frozen=True)
class UserFolder:
    """A folder that only this user may write."""

    path: Path | None  # None: there is no folder, and nothing is kept
    reason: str = ""  # why it is not the usual folder; "" if it is


def user_cache() -> UserFolder:
    """Return the folder for reproducible data: ``$XDG_CACHE_HOME/benchnav``."""
    return _user_folder("XDG_CACHE_HOME", ".cache")


def user_state() -> UserFolder:
    """Return the folder for lasting data: ``$XDG_STATE_HOME/benchnav``."""
    return _user_folder("XDG_STATE_HOME", ".local/state")


def home_is_usable() -> bool:
    """Whether other libraries can write to the user's home."""
    try:
        return os.access(Path.home(), os.W_OK | os.X_OK)
    except RuntimeError:
        return False


def create_private(folder: Path) -> None:
    """Create ``folder`` if it is missing.

    Raises OSError if it cannot be created or written, or belongs to another user.
    """
    existing = next(place for place in (folder, *folder.parents) if os.path.exists(place))  # noqa: PTH110 - Path.exists raises on what may not be read
    _require_owner(existing, (_user(), _ROOT))
    folder.mkdir(mode=0o755, parents=True, exist_ok=True)
    if not os.access(folder, os.R_OK | os.W_OK | os.X_OK):
        raise PermissionError(0, "it cannot be written", str(folder))
    if folder.stat().st_mode & stat.S_IWOTH:
        raise PermissionError(0, "every user can write it", str(folder))


def _user_folder(variable: str, below_home: str) -> UserFolder:
    try:
        folder = _usual(variable, below_home) / _NAME
        create_private(folder)
    except OSError as error:
        refused = _sentence(error)
    else:
        return UserFolder(folder)
    try:
        folder = _temporary_home() / below_home / _NAME
        create_private(folder)
    except OSError as error:
        return UserFolder(None, f"{refused}; {_sentence(error)}")
    return UserFolder(folder, refused)


def _usual(variable: str, below_home: str) -> Path:
    """Return the standard folder. Raises OSError if neither variable nor home gives one."""
    given = Path(os.environ.get(variable) or "")
    if given.is_absolute():  # the XDG standard ignores relative paths
        return given
    try:
        home = Path.home()
    except RuntimeError:
        raise FileNotFoundError(f"HOME is not set and user {_user()} has no home") from None
    if not home.is_absolute():
        raise FileNotFoundError(f"HOME must be an absolute path, got {str(home)!r}")
    return home / below_home


def _temporary_home() -> Path:
    """Return the user's private home in the temporary folder, which others cannot prepare.

    Raises OSError if it cannot be created, or another user created one of that name.
    """
    folder = Path(tempfile.gettempdir()) / f"{_NAME}-{_user()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    if not stat.S_ISDIR(folder.lstat().st_mode):
        raise NotADirectoryError(0, "it must be a folder, not a link", str(folder))
    _require_owner(folder, (_user(),))
    folder.chmod(0o700)
    return folder


def _require_owner(folder: Path, users: tuple[int, ...]) -> None:
    owner = folder.stat().st_uid
    if owner not in users:
        raise PermissionError(0, f"it belongs to another user ({owner})", str(folder))


def _user() -> int:
    """Return the user number; 0, the owner of every file, on systems without user numbers."""
    return os.geteuid() if hasattr(os, "geteuid") else 0


def _sentence(error: OSError) -> str:
    return f"{error.filename} cannot be used: {error.strerror}" if error.filename else str(error)
