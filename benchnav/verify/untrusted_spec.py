"""What a navigator's parameters name that no stranger may make this machine import or start."""

import re
from collections.abc import Mapping
from typing import Any

from benchnav.isolation.subprocess_host import PROCESS

_BY_MODULE = re.compile(r"[A-Za-z_][\w.]*:[A-Za-z_][\w.]*")


def is_program(spec: Any) -> bool:
    """Whether a program of the stranger's would be started."""
    if isinstance(spec, Mapping):
        return is_program(spec.get("type")) or any(map(is_program, spec.values()))
    return isinstance(spec, str) and spec == PROCESS


def is_by_module(spec: Any) -> bool:
    """Whether something is named as ``module:attribute``."""
    if isinstance(spec, Mapping):
        return any(is_by_module(value) for value in spec.values())
    if isinstance(spec, list | tuple):
        return any(is_by_module(value) for value in spec)
    return isinstance(spec, str) and _BY_MODULE.fullmatch(spec) is not None
