"""Failures of the machine (files, memory, processes) as sentences with the cure."""

import errno

_CURES = {
    errno.EMFILE: "Allow this process more of them (ulimit -n 1024).",
    errno.ENFILE: "Close other programs, or allow this machine more of them.",
    errno.ENOMEM: "Allow this process more memory (ulimit -v), or give fewer --workers.",
    errno.EAGAIN: "Allow this user more processes (ulimit -u), or give fewer --workers.",
}
_NO_THREAD = "can't start new thread"  # distinguishes it from other RuntimeErrors


def machine_fault(error: BaseException) -> str:
    """Return the sentence for an error of the machine; "" for any other error."""
    if isinstance(error, MemoryError):
        return f"Memory is short. {_CURES[errno.ENOMEM]}"
    if isinstance(error, RuntimeError) and str(error) == _NO_THREAD:
        return f"No further thread can be started. {_CURES[errno.EAGAIN]}"
    if isinstance(error, ImportError):  # a library is incomplete or does not fit
        return (
            f"{error}. Allow this process more memory and files (ulimit -v, -n), or install again."
        )
    if not isinstance(error, OSError):
        return ""
    place = f"{error.filename}: " if error.filename else ""
    cure = _CURES.get(error.errno or 0)
    return f"{place}{error.strerror or error}" + (f". {cure}" if cure else "")
