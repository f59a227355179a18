"""The navigator that `--isolate` uses: any navigator by name, hosted in a separate process."""

import json
import sys
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import asdict
from typing import Any

from benchnav.arena.sensing import Sensing
from benchnav.errors import BrokenPluginError, NavigatorError, UsageError
from benchnav.isolation import process_pool, sandbox
from benchnav.isolation.navigator_process import Process
from benchnav.isolation.remote_navigator import Remote, handshake, python_path
from benchnav.named_module import current_folder
from benchnav.navigation.plugin.capabilities import Capabilities
from benchnav.navigation.plugin.configure import Spec, split
from benchnav.plugins import NAVIGATORS
from benchnav.source.parts import local_names

HOST = (sys.executable, "-P", "-m", "benchnav.isolation.host")


class Isolated(Remote):
    """The navigator of ``spec``; ``key`` names the job that runs it and keeps its process alive."""

    def __init__(self, spec: Spec, key: Hashable) -> None:
        super().__init__()
        self._spec = spec if isinstance(spec, str) else dict(spec)
        self._key = (json.dumps(self._spec, sort_keys=True), key)

    def start(self) -> Process:
        sandbox.require_sandbox()
        return process_pool.acquire(self._key, lambda: Process(HOST))

    @property
    def hello(self) -> Mapping[str, Any]:
        return _hello(self._spec)


def read_capabilities(
    spec: Spec, sensings: Sequence[Sensing] = (), *, where: str = ""
) -> Capabilities:
    """Return the capabilities of a navigator, from a separate process.

    This process imports nothing of the navigator. Raises also BrokenPluginError if the process
    dies, and UsageError if no other process can host the navigator.
    """
    name, parameters = split(NAVIGATORS, spec, where=where)
    for local in local_names({"type": name, **parameters}):
        raise UsageError(
            f"{where + ': ' if where else ''}An isolated navigator and its parts must be installed,"
            f" or named as module:Class. Got {local!r} instead, which is registered in this"
            " process alone."
        )
    sandbox.require_sandbox()
    process = Process(HOST)
    try:
        request = {"where": where, "sensings": [asdict(sensing) for sensing in sensings]}
        return handshake(process, {**_hello(spec), **request})
    except NavigatorError as error:
        raise BrokenPluginError(f"The navigator {name!r} cannot be used: {error}.") from None
    finally:
        process.stop()


def _hello(spec: Spec) -> dict[str, Any]:
    navigator = spec if isinstance(spec, str) else dict(spec)
    return {"navigator": navigator, "path": python_path(), "folder": str(current_folder())}
