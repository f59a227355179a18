"""Checks for navigators whose use would import or start untrusted code."""

import re
from collections.abc import Mapping
from typing import Any

from benchnav.isolation.subprocess_host import PROCESS

_BY_MODULE = re.compile(r"[A-Za-z_][\w.]*:[A-Za-z_][\w.]*")


def is_program(spec: Any) -> bool:
    """Whether the navigator is an untrusted program."""
    if isinstance(spec, Mapping):
        return is_program(spec.get("type")) or any(map(is_program, spec.values()))
    return isinstance(spec, str) and spec == PROCESS


def is_by_module(spec: Any) -> bool:
    """Whether a navigator or a part of it is named as ``module:attribute``."""
    if isinstance(spec, Mapping):
        return any(is_by_module(value) for value in spec.values())
    if isinstance(spec, list | tuple):
        return any(is_by_module(value) for value in spec)
    return isinstance(spec, str) and _BY_MODULE.fullmatch(spec) is not None
