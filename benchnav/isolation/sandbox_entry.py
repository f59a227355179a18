"""Run a program inside the rest of the sandbox: ``python -I -S enclose.py PROGRAM ARGUMENT…``.

`benchnav.isolation.sandbox` starts this file in new namespaces, where it still has every
capability. It makes the kernel's own files read-only, leaves only harmless devices, drops every
capability for good, and then becomes the program. It imports no_capabilities of benchnav.
"""

import ctypes
import os
import struct
import sys
from pathlib import Path

DEVICES = ("null", "zero", "full", "random", "urandom")
ACCELERATORS = ("nvidia*", "dri", "kfd", "dxg")
LINKS = {"fd": "fd", "stdin": "fd/0", "stdout": "fd/1", "stderr": "fd/2"}

_MOUNT_SETATTR = 442  # the number of this system call on every architecture
_AT_FDCWD, _AT_RECURSIVE = -100, 0x8000
_READ_ONLY = 0x1 | 0x2 | 0x4 | 0x8  # also no set-user-id, no devices, no execution
_MS_NOSUID, _MS_NOEXEC, _MS_BIND, _MS_REC = 2, 8, 4096, 16384
_PR_CAPBSET_DROP, _PR_SET_NO_NEW_PRIVS, _PR_CAP_AMBIENT, _CLEAR_ALL = 24, 38, 47, 4
_CAPABILITY_VERSION, _CAPABILITIES = 0x20080522, 64

_libc = ctypes.CDLL(None, use_errno=True)


def make_read_only(folder: str) -> None:
    """Make every file system mounted at or below ``folder`` read-only."""
    attributes = struct.pack("4Q", _READ_ONLY, 0, 0, 0)
    _check(
        _libc.syscall(
            _MOUNT_SETATTR, _AT_FDCWD, folder.encode(), _AT_RECURSIVE, attributes, len(attributes)
        ),
        folder,
    )


def leave_harmless_devices() -> None:
    """Replace ``/dev`` by a folder with `DEVICES`, `ACCELERATORS` and an own ``shm``."""
    dev = Path("/dev")
    kept = [dev / name for name in DEVICES]
    kept += [path for pattern in ACCELERATORS for path in sorted(dev.glob(pattern))]
    descriptors = {path: os.open(path, os.O_PATH) for path in kept if path.exists()}
    _mount("tmpfs", dev, "tmpfs", _MS_NOSUID | _MS_NOEXEC, b"mode=755")
    for path, descriptor in descriptors.items():
        source = f"/proc/self/fd/{descriptor}"
        if Path(source).is_dir():
            path.mkdir()
        else:
            path.touch()
        _mount(source, path, None, _MS_BIND | _MS_REC)
        os.close(descriptor)
    for name, target in LINKS.items():
        (dev / name).symlink_to(f"/proc/self/{target}")
    (dev / "shm").mkdir()
    (dev / "shm").chmod(0o1777)


def drop_capabilities() -> None:
    """Drop every capability, and the right to regain one by starting a program."""
    for capability in range(_CAPABILITIES):  # the kernel refuses the numbers that it does not know
        _libc.prctl(_PR_CAPBSET_DROP, capability, 0, 0, 0)
    _check(_libc.prctl(_PR_CAP_AMBIENT, _CLEAR_ALL, 0, 0, 0), "capabilities")
    header, no_capabilities = struct.pack("Ii", _CAPABILITY_VERSION, 0), bytes(24)
    _check(_libc.capset(header, no_capabilities), "capabilities")
    _check(_libc.prctl(_PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0), "capabilities")


def _mount(
    source: str, target: Path, kind: str | None, flags: int, options: bytes | None = None
) -> None:
    done = _libc.mount(
        source.encode(), os.fsencode(target), kind.encode() if kind else None,
        ctypes.c_ulong(flags), options,
    )  # fmt: skip
    _check(done, str(target))


def _check(result: int, subject: str) -> None:
    """Raise OSError about ``subject`` if a system call failed."""
    if result != 0:
        number = ctypes.get_errno()
        raise OSError(number, os.strerror(number), subject)


def main() -> None:
    """Enclose this process, then become the program."""
    leave_harmless_devices()
    make_read_only("/proc")
    make_read_only("/sys")
    drop_capabilities()
    os.execvp(sys.argv[1], sys.argv[1:])  # noqa: S606 - the program is the user's


if __name__ == "__main__":
    main()
