"""Read the requests of the runner: from a pipe, and from shared memory where both sides agree."""

import os
from typing import Any

from benchnav.isolation.frame import HEAD, decode, head
from benchnav.isolation.shared_memory import open_offered


class RequestReader:
    """Reads frames from the file descriptor ``file``."""

    def __init__(self, file: int) -> None:
        self._file = file
        self._offered: memoryview | None = None
        self._agreed = False  # whether fields lie in the memory

    def read(self) -> tuple[str, dict[str, Any]] | None:
        """Return (kind, fields) of the next request; None if there are no more."""
        start = self._receive(HEAD.size)
        if start is None:
            return None
        kind, count, size = head(start)
        if kind == "hello":
            self._agreed = False
        if self._agreed and self._offered and size <= len(self._offered):
            return kind, decode(count, bytearray(self._offered[:size]))
        body = self._receive(size)
        return None if body is None else (kind, decode(count, body))

    def agree(self, fields: dict[str, Any]) -> bool:
        """Return whether to use the memory that the fields of `hello` offer from now on."""
        if self._offered is None and "memory" in fields:
            self._offered = open_offered(*fields["memory"].tolist())
        self._agreed = self._offered is not None and "memory" in fields
        return self._agreed

    def _receive(self, size: int) -> bytearray | None:
        """Return ``size`` bytes; None if the file ends before."""
        data = bytearray(size)
        rest = memoryview(data)
        while rest:
            count = os.readv(self._file, [rest])
            if not count:
                return None
            rest = rest[count:]
        return data
