"""The sandbox of a navigator's process: its environment, and what it can reach.

Where Linux allows it (user namespaces of an ordinary user, util-linux), the process runs in its
own namespaces (users, processes, network, IPC, host name, mounts). It sees no other process, has
no capability, cannot write the kernel's own files (the user number of root alone would allow
that), and finds only harmless devices (`benchnav.isolation.sandbox_entry`). On any Linux, the
runner's memory is made unreadable to other processes of its user (`PR_SET_DUMPABLE`).
`require_sandbox` tests both.
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
_SANDBOXES = (
    (*_DIE_WITH_RUNNER, *_ENCLOSED), _ENCLOSED, (*_DIE_WITH_RUNNER, *_NAMESPACES), _NAMESPACES,
    _DIE_WITH_RUNNER,
)  # fmt: skip
_PROBE = """
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
    """Return the environment variables of a navigator's process; ``folder`` is its own folder."""
    kept = {name: os.environ[name] for name in INHERITED if name in os.environ}
    cache = user_cache()
    if cache.reason and cache.path is not None:  # TMPDIR changes its default
        kept["XDG_CACHE_HOME"] = str(cache.path.parent)
    return {**kept, "TMPDIR": str(folder), "PYTHONSAFEPATH": "1"}


@cache
def prefix() -> tuple[str, ...]:
    """Return the command prefix that starts a program in the strongest sandbox available here."""
    for sandbox in _SANDBOXES:
        if _works(sandbox):
            return sandbox
    return ()


@cache
def require_sandbox() -> None:
    """Make this process's memory unreadable, and test that from inside the sandbox.

    Raises UsageError if a sandboxed process could read this process's memory or change
    settings of the machine.
    """
    hide_memory()
    if not sys.platform.startswith("linux"):
        return  # other systems have no memory file, and their other ways need a permission
    secret = ctypes.create_string_buffer(b"\x5a")
    location = (str(os.getpid()), str(ctypes.addressof(secret)))
    probe = [*prefix(), sys.executable, "-I", "-S", "-c", _PROBE, *location]
    found = subprocess.run(probe, capture_output=True, text=True, check=False)  # noqa: S603
    reached = found.stdout.split("\n")
    if reached[:1] != ["closed"]:
        raise UsageError(
            "Isolated navigators must not be able to read the memory of the runner, or to change"
            f" the machine. Here they could {reached[0].strip() or 'not be started'}: namespaces"
            " cannot be created (unshare --user --mount), and this user has all privileges."
            f" Run as an ordinary user, or allow user namespaces.{_last_line(found.stderr)}"
        )


def hide_memory() -> None:
    """Make this process's memory unreadable to other processes of this user (Linux)."""
    if sys.platform.startswith("linux"):
        ctypes.CDLL(None).prctl(_PR_SET_DUMPABLE, 0, 0, 0, 0)


def _works(sandbox: tuple[str, ...]) -> bool:
    try:
        result = subprocess.run([*sandbox, "true"], capture_output=True, timeout=10, check=False)  # noqa: S603
    except (OSError, subprocess.TimeoutExpired):
        return False
    return result.returncode == 0


def _last_line(stderr: str) -> str:
    return f" Its last output: {stderr.strip().splitlines()[-1]}" if stderr.strip() else ""
