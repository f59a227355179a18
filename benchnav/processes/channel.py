"""Messages between two processes as bounded JSON frames; the reader trusts none of them."""

import json
import select
import socket
import struct
from typing import Any

MAX_SIZE = 16 << 20  # bytes of a message
PATIENCE = 10.0  # [s] for the other side to accept a message
_HEAD = struct.Struct(">I")


class ChannelError(Exception):
    """The other side sent something that is not a message, or accepts none."""


class ChannelClosedError(ChannelError):
    """The other side has ended or closed its end, so it accepts no message."""


class Channel:
    """One end of a socket pair.

    Use `arrived` where the caller must not wait for the other side, else `receive`.
    """

    def __init__(self, end: socket.socket) -> None:
        self._end = end
        self._received = bytearray()

    def fileno(self) -> int:
        """Return the descriptor for `select`."""
        return self._end.fileno()

    def close(self) -> None:
        """Close this end; the other end notices it."""
        self._end.close()

    def send(self, message: Any) -> None:
        """Send a JSON value. Raises ChannelError, also if the other side is gone."""
        self.send_bytes(json.dumps(message).encode())

    def send_bytes(self, data: bytes) -> None:
        """Send raw bytes. Raises ChannelError."""
        if len(data) > MAX_SIZE:
            raise ChannelError(f"a message must have at most {MAX_SIZE} bytes; got {len(data)}")
        try:
            self._end.settimeout(PATIENCE)
            self._end.sendall(_HEAD.pack(len(data)) + data)
        except BrokenPipeError as error:
            raise ChannelClosedError(f"the other side has closed its end ({error})") from None
        except OSError as error:
            raise ChannelError(f"the other side accepts no message ({error})") from None

    def arrived(self) -> list[Any]:
        """Return the complete messages received so far, without waiting.

        Raises EOFError if the other side has closed, ChannelError if it sent no message.
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
            messages.append(_decode(frame))
        return messages

    def receive(self, patience: float | None = None) -> Any:
        """Return the next message; a ``patience`` [s] of None waits for ever.

        Raises EOFError, ChannelError, and TimeoutError if no message comes.
        """
        return _decode(self.receive_bytes(patience))

    def receive_bytes(self, patience: float | None = None) -> bytes:
        """Return the next message as raw bytes; see `receive`."""
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
        """Take the first complete message out of the received bytes."""
        if len(self._received) < _HEAD.size:
            return None
        (size,) = _HEAD.unpack_from(self._received)
        if size > MAX_SIZE:
            raise ChannelError("sent something that is not a message")
        if len(self._received) < _HEAD.size + size:
            return None
        frame = bytes(self._received[_HEAD.size : _HEAD.size + size])
        del self._received[: _HEAD.size + size]
        return frame


def _decode(frame: bytes) -> Any:
    try:
        return json.loads(frame)
    except (ValueError, RecursionError):
        raise ChannelError("sent something that is not a message") from None
