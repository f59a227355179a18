"""The fence about a navigator's process: what it inherits, and what it can reach of this one.

Where Linux allows it (namespaces of an ordinary user, util-linux), the process stands in
namespaces of its own (users, processes, network, IPC, host name, mounts): it sees no other
process, has no capability, cannot write the kernel's own files, which root's number alone would
allow, and finds harmless devices only (`benchnav.isolation.sandbox_entry`). Everywhere on Linux
this process is made unreadable to others of its user (`PR_SET_DUMPABLE`). `require_fence` tries
whether that holds.
"""

import ctypes
import os
import subprocess
import sys
from collections.abc import Mapping
from functools import cache
from pathlib import Path

from benchnav.errors import UsageError
from benchnav.system.user_folders import user_cache

INHERITED = (
    "PATH", "HOME", "USER", "LANG", "LC_ALL", "LC_CTYPE", "LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH",
    "SYSTEMROOT", "XDG_CACHE_HOME", "NUMBA_CACHE_DIR", "CUDA_VISIBLE_DEVICES", "BENCHNAV_THREADS",
    "NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS",
)  # fmt: skip
_DIE_WITH_RUNNER = ("setpriv", "--pdeathsig", "KILL")
_NAMESPACES = (
    "unshare", "--user", "--map-user=1000", "--map-group=1000", "--pid", "--fork", "--kill-child",
    "--mount-proc", "--net", "--ipc",
)  # fmt: skip
_ENCLOSED = (
    *_NAMESPACES, "--uts", "--cgroup", "--keep-caps",
    sys.executable, "-I", "-S", str(Path(__file__).with_name("sandbox_entry.py")),
)  # fmt: skip
_FENCES = (
    (*_DIE_WITH_RUNNER, *_ENCLOSED), _ENCLOSED, (*_DIE_WITH_RUNNER, *_NAMESPACES), _NAMESPACES,
    _DIE_WITH_RUNNER,
)  # fmt: skip
_LOOK = """
import os, sys
try:
    with open(f"/proc/{sys.argv[1]}/mem", "rb") as memory:
        memory.seek(int(sys.argv[2]))
        memory.read(1)
    print("read the memory of the runner")
except OSError:
    pass
try:
    os.open("/proc/sys/kernel/hostname", os.O_WRONLY)  # opened, and not written
    print("write settings of the machine (/proc/sys)")
except OSError:
    pass
print("closed")
"""
_PR_SET_DUMPABLE = 4


def environment(folder: Path) -> Mapping[str, str]:
    """The variables that a navigator's process is given; ``folder`` is its own."""
    kept = {name: os.environ[name] for name in INHERITED if name in os.environ}
    cache = user_cache()
    if cache.reason and cache.path is not None:  # among temporary files, whose folder is another
        kept["XDG_CACHE_HOME"] = str(cache.path.parent)
    return {**kept, "TMPDIR": str(folder), "PYTHONSAFEPATH": "1"}


@cache
def prefix() -> tuple[str, ...]:
    """What a command is started by, so that it stands behind the fence that there is here."""
    for fence in _FENCES:
        if _works(fence):
            return fence
    return ()


@cache
def require_fence() -> None:
    """Make this process unreadable, and try it from behind the fence.

    Raises UsageError where what stands behind the fence could read this process's memory, or
    change settings of the machine.
    """
    hide()
    if not sys.platform.startswith("linux"):
        return  # there is no file to read it from, and other ways need the system's permission
    secret = ctypes.create_string_buffer(b"\x5a")
    where = (str(os.getpid()), str(ctypes.addressof(secret)))
    look = [*prefix(), sys.executable, "-I", "-S", "-c", _LOOK, *where]
    found = subprocess.run(look, capture_output=True, text=True, check=False)  # noqa: S603
    reached = found.stdout.split("\n")
    if reached[:1] != ["closed"]:
        raise UsageError(
            "Isolated navigators must not be able to read the memory of the runner, or to change"
            f" the machine. Here they could {reached[0].strip() or 'not be started'}: namespaces"
            " cannot be made (unshare --user --mount), and this user may do everything."
            f" Run as an ordinary user, or allow user namespaces.{_said(found.stderr)}"
        )


def hide() -> None:
    """Let no other process of this user read this one's memory (Linux)."""
    if sys.platform.startswith("linux"):
        ctypes.CDLL(None).prctl(_PR_SET_DUMPABLE, 0, 0, 0, 0)


def _works(fence: tuple[str, ...]) -> bool:
    try:
        tried = subprocess.run([*fence, "true"], capture_output=True, timeout=10, check=False)  # noqa: S603
    except (OSError, subprocess.TimeoutExpired):
        return False
    return tried.returncode == 0


def _said(stderr: str) -> str:
    return f" It said: {stderr.strip().splitlines()[-1]}" if stderr.strip() else ""
