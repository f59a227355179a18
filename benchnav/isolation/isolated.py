"""What `--isolate` does: any navigator by its name, hosted in a process of its own."""

import json
import sys
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import asdict
from typing import Any

from benchnav.arena.sensing import Sensing
from benchnav.errors import BrokenPluginError, NavigatorError, UsageError
from benchnav.isolation import process_pool, sandbox
from benchnav.isolation.navigator_process import Process
from benchnav.isolation.remote_navigator import Remote, python_path, say_hello
from benchnav.named_module import current_folder
from benchnav.navigation.plugin.capabilities import Introduction
from benchnav.navigation.plugin.configure import Spec, split
from benchnav.plugins import NAVIGATORS
from benchnav.source.parts import names_known_here

HOST = (sys.executable, "-P", "-m", "benchnav.isolation.host")


class Isolated(Remote):
    """The navigator of ``spec``; ``cell`` is where it runs, and keeps its process warm."""

    def __init__(self, spec: Spec, cell: Hashable) -> None:
        super().__init__()
        self._spec = spec if isinstance(spec, str) else dict(spec)
        self._cell = (json.dumps(self._spec, sort_keys=True), cell)

    def start(self) -> Process:
        sandbox.require_fence()
        return process_pool.lend(self._cell, lambda: Process(HOST))

    @property
    def hello(self) -> Mapping[str, Any]:
        return _hello(self._spec)


def introduction(spec: Spec, sensings: Sequence[Sensing] = (), *, where: str = "") -> Introduction:
    """As `benchnav.navigation.plugin.capabilities.introduction`, in a process of its own.

    Nothing of the navigator is imported in this one. Raises also BrokenPluginError where the
    process dies, and UsageError where no other process can host it.
    """
    name, parameters = split(NAVIGATORS, spec, where=where)
    for local in names_known_here({"type": name, **parameters}):
        raise UsageError(
            f"{where + ': ' if where else ''}An isolated navigator and its parts must be installed,"
            f" or named as module:Class. Got {local!r} instead, which is registered in this"
            " process alone."
        )
    sandbox.require_fence()
    process = Process(HOST)
    try:
        asked = {"where": where, "sensings": [asdict(sensing) for sensing in sensings]}
        return say_hello(process, {**_hello(spec), **asked})
    except NavigatorError as error:
        raise BrokenPluginError(f"The navigator {name!r} cannot be used: {error}.") from None
    finally:
        process.stop()


def _hello(spec: Spec) -> dict[str, Any]:
    told = spec if isinstance(spec, str) else dict(spec)
    return {"navigator": told, "path": python_path(), "folder": str(current_folder())}
