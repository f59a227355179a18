"""The place where the code of a plugin failed: file and line, and frames for a traceback.

Exceptions come from untrusted code: no function here fails or returns unbounded text,
whatever an exception does when it is read. Paths are those of modules
(``package/module.py``), so the text shows no folder of this machine and is the same on
every machine.
"""

import linecache
import os
import sysconfig
from collections.abc import Iterator
from pathlib import Path, PurePath
from traceback import walk_tb
from types import FrameType
from typing import Any

from benchnav.errors import BenchnavError
from benchnav.text.visible import visible, visible_lines

MOST = 8000  # characters of a traceback
MESSAGE = 1000  # characters of a message in a traceback
LINE = 200  # characters of a line of source
FIRST, LAST = 4, 16  # frames that are shown of a deep stack
CHAIN = 3  # causes of an exception that are shown
SOURCE = 10_000_000  # [bytes] largest file from which source lines are read
RAW = 20_000  # characters that are read of a text

_CORE = str(Path(__file__).parents[2]) + os.sep  # by path: a module may also run as a program
_CALLERS = ("pydantic",)  # other packages that call plugins
_LIBRARIES = tuple(
    {sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib")}
)
_Frames = list[tuple[FrameType, int]]  # with the line that was running, the outermost first


def plain(value: object) -> str:
    """Return ``str(value)`` as valid UTF-8, with control characters (not line breaks) marked."""
    try:
        text = str.__getitem__(str(value), slice(RAW))
    except BaseException:  # also a KeyboardInterrupt that a plugin raises
        return f"(a {class_name(value)} that cannot be read)"
    clean = visible_lines(text).encode("utf-8", "replace").decode()
    home = os.path.expanduser("~")  # noqa: PTH111 - Path.home() raises where there is none
    return clean.replace(home, "~") if len(home) > 1 else clean


def class_name(value: object) -> str:
    """Return the name of the class of ``value``, even if its metaclass overrides the name."""
    name: str = type.__dict__["__name__"].__get__(type(value))
    return visible(str.__getitem__(name, slice(100)))


def location(error: BaseException) -> str:
    """Return ``package/module.py:12``, the innermost line of the plugin's code; "" if unknown."""
    try:
        frames = list(walk_tb(_of(error, "__traceback__")))
        own = _own(frames) or frames
        frame, line = own[-1]
        return f"{_shown(frame)}:{line}"
    except Exception:
        return ""


def trace(error: BaseException) -> str:
    """Return the traceback as text, starting at the first line of the plugin's own code.

    For an error of benchnav with a cause, it is the traceback of the cause.
    """
    try:
        while isinstance(error, BenchnavError) and error.__cause__ is not None:
            error = error.__cause__
        text = "\n".join(_lines(error, CHAIN, {id(error)}))
    except Exception:
        return ""
    return bounded(text)


def bounded(text: object) -> str:
    """Return a traceback as safe text; of a long one only the beginning and the end."""
    shown = plain(text)
    if len(shown) <= MOST:
        return shown
    half = MOST // 2 - 4
    return f"{shown[:half]}\n…\n{shown[-half:]}"


def notes(error: BaseException) -> str:
    """Return the traceback of another process from the notes of an error of benchnav."""
    return "\n".join(getattr(error, "__notes__", ()))


def _lines(error: BaseException, deep: int, seen: set[int]) -> Iterator[str]:
    """Yield the lines of a traceback as Python prints it, the causes of ``error`` first."""
    cause, context = _of(error, "__cause__"), _of(error, "__context__")
    led = cause or (None if _of(error, "__suppress_context__") else context)
    if led is not None and deep and id(led) not in seen:
        yield from _lines(led, deep - 1, {*seen, id(led)})
        how = "was the direct cause of the following" if cause else "was handled when this came"
        yield f"\nThe exception above {how}:\n"
    frames = list(walk_tb(_of(error, "__traceback__")))
    own = _own(frames)
    frames = frames[frames.index(own[0]) :] if own else frames
    if frames:
        yield "Traceback (most recent call last):"
    skipped = len(frames) - FIRST - LAST
    for k, (frame, line) in enumerate(frames):
        if skipped > 0 and FIRST <= k < FIRST + skipped:
            if k == FIRST:
                yield f"  … {skipped} more calls"
            continue
        yield f'  File "{_shown(frame)}", line {line}, in {plain(frame.f_code.co_name)[:100]}'
        if source := plain(_source_line(frame.f_code.co_filename, line)).strip():
            yield f"    {source[:LINE]}"
    message = plain(error)[:MESSAGE].strip()
    yield f"{class_name(error)}: {message}" if message else class_name(error)


def _source_line(path: str, line: int) -> str:
    """Return a line of a regular file: a plugin may name a device or a pipe instead."""
    known = path in linecache.cache  # a cell of a notebook is not a file
    file = Path(path)
    if known or (file.is_file() and file.stat().st_size <= SOURCE):
        return linecache.getline(path, line)
    return ""


def _own(frames: _Frames) -> _Frames:
    """Return the frames of the plugin's package and other local code, without libraries."""
    called = [f for f in frames if not _is_caller(f[0])]
    if not called:
        return []
    first = _package(called[0][0])
    return [f for f in called if _package(f[0]) == first or not _is_library(f[0])]


def _is_caller(frame: FrameType) -> bool:
    return frame.f_code.co_filename.startswith(_CORE) or _package(frame) in _CALLERS


def _package(frame: FrameType) -> str:
    return _module(frame).partition(".")[0]


def _module(frame: FrameType) -> str:
    name = frame.f_globals.get("__name__")
    return name if type(name) is str else ""


def _is_library(frame: FrameType) -> bool:
    path = frame.f_code.co_filename
    return path.startswith(("<frozen", *_LIBRARIES))


def _shown(frame: FrameType) -> str:
    """Return ``package/module.py``, or only the file's name if it differs from the module's."""
    path, module = PurePath(frame.f_code.co_filename), _module(frame)
    if path.parent.name.startswith("ipykernel_"):
        return "<notebook>"
    folders = module.split(".")
    if path.stem == "__init__":
        return plain("/".join((*folders, path.name)))
    return plain("/".join((*folders[:-1], path.name) if folders[-1] == path.stem else (path.name,)))


def _of(error: BaseException, name: str) -> Any:
    """Return an attribute of BaseException, even if the class of ``error`` overrides it."""
    return BaseException.__dict__[name].__get__(error)
