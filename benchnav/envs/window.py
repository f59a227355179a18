"""A window on the display of the session, with tkinter of the standard library."""

import time
from typing import Any

from benchnav.arrays import ByteArray
from benchnav.envs.factory import NoRenderingError


class Window:
    """Shows pictures in real time. A window that the user closes stays closed."""

    def __init__(self, title: str, rate: float) -> None:
        """Open a window for ``rate`` pictures a second.

        Raises NoRenderingError where tkinter or a display is missing.
        """
        self._root, self._label = _opened(title)
        self._root.protocol("WM_DELETE_WINDOW", self.close)
        self._pause, self._next = 1.0 / rate, 0.0
        self.is_open = True

    def show(self, picture: ByteArray) -> None:
        """Show a picture (height, width, 3), not earlier than its time after the last one."""
        from tkinter import PhotoImage

        time.sleep(max(0.0, self._next - time.monotonic()))
        self._next = time.monotonic() + self._pause
        high, wide = picture.shape[:2]
        data = b"P6 %d %d 255 " % (wide, high) + picture.tobytes()
        image = PhotoImage(master=self._root, data=data)
        self._label.configure(image=image)
        self._label.image = image  # tkinter keeps no reference of its own
        self._root.update()

    def close(self) -> None:
        """Close the window, if it is still open."""
        if self.is_open:
            self.is_open = False
            self._root.destroy()


def _opened(title: str) -> tuple[Any, Any]:
    """Return a window and the label in it that shows pictures."""
    instead = 'or use render_mode="rgb_array", which returns pictures'
    try:
        import tkinter
    except ImportError as error:
        raise NoRenderingError(
            'render_mode="human" needs tkinter, which is missing from this Python: install it'
            f" (Debian and Ubuntu: apt install python3-tk), {instead}."
        ) from error
    try:
        root = tkinter.Tk()
    except tkinter.TclError as error:
        raise NoRenderingError(
            f'render_mode="human" needs a display ({error}): work in a desktop session or with'
            f" ssh -X, {instead}."
        ) from error
    root.title(title)
    root.resizable(False, False)
    label = tkinter.Label(root, borderwidth=0)
    label.pack()
    return root, label
