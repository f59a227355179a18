"""Where the code of a plugin failed: file and line for a reason, frames for a traceback.

Exceptions come from strangers: nothing here fails, or returns text without bounds, whatever
one of them does when it is read. Paths are those of modules (``package/module.py``), so that
no folder of this machine appears and the same fault reads the same everywhere.
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
CHAIN = 3  # exceptions that led to another one
SOURCE = 10_000_000  # bytes of a file that lines are taken from
RAW = 20_000  # characters that are looked at of a text

_CORE = str(Path(__file__).parents[2]) + os.sep  # also where a part of it is run as a program
_CALLERS = ("pydantic",)  # packages that call plugins, besides
_LIBRARIES = tuple(
    {sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib")}
)
_Frames = list[tuple[FrameType, int]]  # with the line that was running, the outermost first


def plain(value: object) -> str:
    """``str(value)`` that can be written as UTF-8: control characters but line breaks marked."""
    try:
        text = str.__getitem__(str(value), slice(RAW))
    except BaseException:  # also a KeyboardInterrupt that a plugin raises
        return f"(a {class_name(value)} that cannot be read)"
    clean = visible_lines(text).encode("utf-8", "replace").decode()
    home = os.path.expanduser("~")  # noqa: PTH111 - Path.home() raises where there is none
    return clean.replace(home, "~") if len(home) > 1 else clean


def class_name(value: object) -> str:
    """The name of the class of ``value``, whatever its metaclass says."""
    name: str = type.__dict__["__name__"].__get__(type(value))
    return visible(str.__getitem__(name, slice(100)))


def location(error: BaseException) -> str:
    """``package/module.py:12``, the innermost line of the plugin's own code; "" if unknown."""
    try:
        frames = list(walk_tb(_of(error, "__traceback__")))
        own = _own(frames) or frames
        frame, line = own[-1]
        return f"{_shown(frame)}:{line}"
    except Exception:
        return ""


def trace(error: BaseException) -> str:
    """The traceback as text, from the first line of the plugin's own code on.

    Of an error of benchnav that something else caused, it is the traceback of that.
    """
    try:
        while isinstance(error, BenchnavError) and error.__cause__ is not None:
            error = error.__cause__
        text = "\n".join(_lines(error, CHAIN, {id(error)}))
    except Exception:
        return ""
    return bounded(text)


def bounded(text: object) -> str:
    """A traceback that another process sent, or one too long: its begin and its end."""
    shown = plain(text)
    if len(shown) <= MOST:
        return shown
    half = MOST // 2 - 4
    return f"{shown[:half]}\n…\n{shown[-half:]}"


def notes(error: BaseException) -> str:
    """The traceback of another process that an error of benchnav carries."""
    return "\n".join(getattr(error, "__notes__", ()))


def _lines(error: BaseException, deep: int, seen: set[int]) -> Iterator[str]:
    """As Python prints it, what led to ``error`` first."""
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
    """Of a file that is one: a plugin may name a device or a pipe instead."""
    known = path in linecache.cache  # a cell of a notebook is no file
    file = Path(path)
    if known or (file.is_file() and file.stat().st_size <= SOURCE):
        return linecache.getline(path, line)
    return ""


def _own(frames: _Frames) -> _Frames:
    """The frames of the plugin, of its package or beside it, without the libraries it calls."""
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
    """``package/module.py``; the file's name alone where it is not that of the module."""
    path, module = PurePath(frame.f_code.co_filename), _module(frame)
    if path.parent.name.startswith("ipykernel_"):
        return "<notebook>"
    folders = module.split(".")
    if path.stem == "__init__":
        return plain("/".join((*folders, path.name)))
    return plain("/".join((*folders[:-1], path.name) if folders[-1] == path.stem else (path.name,)))


def _of(error: BaseException, name: str) -> Any:
    """An attribute that every exception has, whatever its class puts in its place."""
    return BaseException.__dict__[name].__get__(error)
