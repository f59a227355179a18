"""The user's own folders: of the cache, and of what is remembered between commands.

They are those of the XDG base directories. Where these cannot be used (no home, an unknown
user, the home of another user, a read-only disk), a private folder among the temporary files
takes their place. A folder that another user could write is never used: compiled code is
loaded from there.
"""

import os
import stat
import tempfile
from dataclasses import dataclass
from pathlib import Path

_NAME = "benchnav"
_ROOT = 0  # the user who may write everywhere anyway


@dataclass(frozen=True)
class UserFolder:
    """A folder that this user, and no other, may write."""

    path: Path | None  # None where there is none: nothing can be kept
    reason: str = ""  # why it is not the usual one; "" if it is


def user_cache() -> UserFolder:
    """Return where what can be made again is kept: ``$XDG_CACHE_HOME/benchnav``."""
    return _user_folder("XDG_CACHE_HOME", ".cache")


def user_state() -> UserFolder:
    """Return where what must be remembered is kept: ``$XDG_STATE_HOME/benchnav``."""
    return _user_folder("XDG_STATE_HOME", ".local/state")


def home_is_usable() -> bool:
    """Whether other libraries can keep their files in the user's home."""
    try:
        return os.access(Path.home(), os.W_OK | os.X_OK)
    except RuntimeError:
        return False


def make_own(folder: Path) -> None:
    """Make ``folder`` where it is missing.

    Raises OSError where it cannot be made or written, or belongs to another user.
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
        make_own(folder)
    except OSError as error:
        refused = _sentence(error)
    else:
        return UserFolder(folder)
    try:
        folder = _temporary_home() / below_home / _NAME
        make_own(folder)
    except OSError as error:
        return UserFolder(None, f"{refused}; {_sentence(error)}")
    return UserFolder(folder, refused)


def _usual(variable: str, below_home: str) -> Path:
    """Raise OSError where neither the variable nor the home names a folder."""
    given = Path(os.environ.get(variable) or "")
    if given.is_absolute():  # the standard ignores others
        return given
    try:
        home = Path.home()
    except RuntimeError:
        raise FileNotFoundError(f"HOME is not set and user {_user()} has no home") from None
    if not home.is_absolute():
        raise FileNotFoundError(f"HOME must be an absolute path, got {str(home)!r}")
    return home / below_home


def _temporary_home() -> Path:
    """The user's private folder among the temporary files; others cannot plant anything there.

    Raises OSError where it cannot be made, or another user made one of that name.
    """
    folder = Path(tempfile.gettempdir()) / f"{_NAME}-{_user()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    if not stat.S_ISDIR(folder.lstat().st_mode):
        raise NotADirectoryError(0, "it must be a folder and no link", str(folder))
    _require_owner(folder, (_user(),))
    folder.chmod(0o700)
    return folder


def _require_owner(folder: Path, users: tuple[int, ...]) -> None:
    owner = folder.stat().st_uid
    if owner not in users:
        raise PermissionError(0, f"it belongs to another user ({owner})", str(folder))


def _user() -> int:
    """The number of the user; 0, which owns every file, on systems without."""
    return os.geteuid() if hasattr(os, "geteuid") else 0


def _sentence(error: OSError) -> str:
    return f"{error.filename} cannot be used: {error.strerror}" if error.filename else str(error)
