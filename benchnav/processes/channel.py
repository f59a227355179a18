"""Messages between two processes, of which the reader believes nothing: bounded JSON frames."""

import json
import select
import socket
import struct
from typing import Any

MOST = 16 << 20  # bytes of a message
PATIENCE = 10.0  # [s] for the other side to make room for what it is sent
_HEAD = struct.Struct(">I")


class ChannelError(Exception):
    """The other side sent what is no message, or takes none."""


class Channel:
    """One end of a pair of sockets.

    Who must not wait for the other side calls `arrived`; who may calls `receive`.
    """

    def __init__(self, end: socket.socket) -> None:
        self._end = end
        self._received = bytearray()

    def fileno(self) -> int:
        """For `select`."""
        return self._end.fileno()

    def close(self) -> None:
        """Close this end; the other one sees it."""
        self._end.close()

    def send(self, message: Any) -> None:
        """Send what JSON can say. Raises ChannelError, also where the other side is gone."""
        self.send_bytes(json.dumps(message).encode())

    def send_bytes(self, data: bytes) -> None:
        """Send bytes as they are. Raises ChannelError."""
        if len(data) > MOST:
            raise ChannelError(f"a message must have at most {MOST} bytes; got {len(data)}")
        try:
            self._end.settimeout(PATIENCE)
            self._end.sendall(_HEAD.pack(len(data)) + data)
        except OSError as error:
            raise ChannelError(f"nobody takes what is sent ({error})") from None

    def arrived(self) -> list[Any]:
        """Return the whole messages that are here, without waiting.

        Raises EOFError where the other side has closed, ChannelError for what is no message.
        """
        try:
            self._end.settimeout(0.0)
            data = self._end.recv(1 << 16)
        except BlockingIOError:
            return []
        except OSError:
            data = b""
        if not data:
            raise EOFError
        self._received += data
        messages = []
        while (frame := self._frame()) is not None:
            messages.append(_decoded(frame))
        return messages

    def receive(self, patience: float | None = None) -> Any:
        """Return the next message; None for ``patience`` [s] waits for ever.

        Raises EOFError, ChannelError, and TimeoutError where none comes.
        """
        return _decoded(self.receive_bytes(patience))

    def receive_bytes(self, patience: float | None = None) -> bytes:
        """The same of bytes as they are."""
        while (frame := self._frame()) is None:
            if not select.select([self._end], [], [], patience)[0]:
                raise TimeoutError
            try:
                self._end.settimeout(None)
                data = self._end.recv(1 << 16)
            except OSError:
                data = b""
            if not data:
                raise EOFError
            self._received += data
        return frame

    def _frame(self) -> bytes | None:
        """Take the first whole message out of what was received."""
        if len(self._received) < _HEAD.size:
            return None
        (size,) = _HEAD.unpack_from(self._received)
        if size > MOST:
            raise ChannelError("sent what is no message")
        if len(self._received) < _HEAD.size + size:
            return None
        frame = bytes(self._received[_HEAD.size : _HEAD.size + size])
        del self._received[: _HEAD.size + size]
        return frame


def _decoded(frame: bytes) -> Any:
    try:
        return json.loads(frame)
    except (ValueError, RecursionError):
        raise ChannelError("sent what is no message") from None
