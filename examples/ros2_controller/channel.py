"""The connection between the navigator and a node: JSON over a Unix socket, one object a line.

A Unix socket has a file name, so the sandbox of the navigator, which has no network, can reach it.
The node greets with {"start": T}; then it answers each request with one line:

    request  {"publish": [{"topic", "type", "message"}, …], "await": {topic: type}}
    answer   {"received": {topic: message}}

Infinity and NaN are written as Python's json does. Numbers keep all their bits.
"""

import contextlib
import json
import socket
from collections.abc import Callable
from pathlib import Path
from typing import Any

_LONGEST = 1 << 24  # bytes of a line


class ChannelError(Exception):
    """The other side is missing, silent or invalid; the text is a sentence for people."""


class Channel:
    """One end of a connection; ``name`` is that of the other end in messages."""

    def __init__(self, connected: socket.socket, name: str) -> None:
        self._socket = connected
        self._file = connected.makefile("rwb")
        self._name = name

    def send(self, message: dict[str, Any]) -> None:
        """Send one message. Raises ChannelError if that fails."""
        with self._explained():
            self._file.write(json.dumps(message).encode() + b"\n")
            self._file.flush()

    def receive(self) -> dict[str, Any]:
        """Return the next message. Raises ChannelError if none comes."""
        with self._explained():
            line = self._file.readline(_LONGEST)
        if not line.endswith(b"\n"):
            raise ChannelError(f"{self._name} closed the connection")
        with contextlib.suppress(ValueError):
            if isinstance(message := json.loads(line), dict):
                return message
        raise ChannelError(
            f"{self._name} must send a JSON object per line. Got {line[:80]!r} instead"
        )

    def close(self) -> None:
        """End the connection."""
        with contextlib.suppress(OSError):
            self._file.close()
        self._socket.close()

    @contextlib.contextmanager
    def _explained(self) -> Any:
        try:
            yield
        except TimeoutError:
            limit = self._socket.gettimeout() or 0.0
            raise ChannelError(f"{self._name} did not answer within {limit:g} s") from None
        except OSError:
            raise ChannelError(f"{self._name} closed the connection") from None


def connect(path: str, timeout: float) -> Channel:
    """Return a channel to the node that listens at ``path``; ``timeout`` [s] is for each message.

    Raises ChannelError if no node listens there.
    """
    connected = socket.socket(socket.AF_UNIX)
    connected.settimeout(timeout)
    try:
        connected.connect(path)
    except OSError as error:
        connected.close()
        reason = (error.strerror or str(error)).lower()
        raise ChannelError(f"no node listens at {path} ({reason}). Start the node first") from None
    return Channel(connected, f"the node at {path}")


def serve(path: str, handle: Callable[[Channel], None]) -> None:
    """Listen at ``path``, and call ``handle`` with each connection, one after another."""
    if Path(path).is_socket():  # of a node that was stopped
        Path(path).unlink()
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind(path)
        listening.listen()
        while True:
            channel = Channel(listening.accept()[0], "the navigator")
            with contextlib.suppress(ChannelError):  # the episode has ended
                handle(channel)
            channel.close()
