"""The exception tree. Everything that a user can cause derives from one class.

BenchnavError
├── UsageError               asked wrongly: an option, a name, a combination (exit status 2)
├── InputError               a file is wrong; the text says file:line:key (exit status 2)
│   ├── ScenarioError        a scenario, suite or recipe file
│   ├── MapError             an occupancy map, a .scen file
│   └── MeshError            a mesh
├── UnsolvableError          a scenario that cannot be drawn
├── PluginError              a navigator, planner, controller, metric or scenario plugin
│   ├── UnknownPluginError   no such name (the nearest names are given)
│   ├── PluginConflictError  two distributions claim one name (both are named)
│   ├── BrokenPluginError    the plugin fails to import (its cause is given)
│   └── ConfigError          parameters that its Config refuses
├── MissingExtraError        an optional dependency is not installed (the pip line is given)
├── TrainingError            learning went wrong: a number that is no longer finite
├── NavigatorError           a navigator raised, answered garbage, or broke its contract
└── StoreError               what lies on disk
    ├── NoRunError           there is no run where one was named (exit status 2)
    ├── RunConflictError     the folder holds another suite's run, or another process writes it
    └── CorruptPartError     a part is cut short, changed or missing
        └── ForeignRowError  a part holds rows of another cell or seed

Grammar of every message: what must be what; what came instead; the nearest right
thing; where.
"""

from collections.abc import Iterable
from difflib import get_close_matches


class BenchnavError(Exception):
    """Base of everything that benchnav raises on purpose."""


class UsageError(BenchnavError):
    """Something was asked for in a way that cannot be done."""


class InputError(BenchnavError):
    """A file says something that it may not say."""


class ScenarioError(InputError):
    """A scenario or suite file is wrong."""


class MapError(InputError):
    """An occupancy map or its companion file is wrong."""


class MeshError(InputError):
    """A mesh file is wrong."""


class UnsolvableError(BenchnavError):
    """A scenario whose worlds cannot be drawn or cannot be solved."""


class PluginError(BenchnavError):
    """A plugin cannot be used."""


class UnknownPluginError(PluginError):
    """No plugin has this name."""


class PluginConflictError(PluginError):
    """Two distributions claim one name."""


class BrokenPluginError(PluginError):
    """A plugin fails to import."""


class ConfigError(PluginError):
    """A plugin's Config refuses its parameters."""


class MissingExtraError(BenchnavError):
    """An optional dependency is not installed."""

    def __init__(self, what: str, extra: str) -> None:
        super().__init__(f"{what} needs an extra: pip install 'benchnav[{extra}]'")


class TrainingError(BenchnavError):
    """Learning went wrong; what was reached before is kept."""


class NavigatorError(BenchnavError):
    """A navigator raised, or answered something that is not a command."""


class StoreError(BenchnavError):
    """Something on disk is not what it must be."""


class NoRunError(StoreError):
    """There is no run where one was named."""


class RunConflictError(StoreError):
    """The run folder belongs to something else."""


class CorruptPartError(StoreError):
    """A part of a run cannot be trusted."""


class ForeignRowError(CorruptPartError):
    """A part holds rows of another cell, or of a seed that is not its own."""


def named(name: str, text: str) -> BenchnavError:
    """The error of this name with this text, as another process told of it."""
    kind = globals().get(name)
    if not (isinstance(kind, type) and issubclass(kind, BenchnavError)):
        kind = BenchnavError
    error: BenchnavError = kind.__new__(kind)
    error.args = (text,)
    return error


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """``" Did you mean 'x' or 'y'?"`` for the nearest known names, or ``""``."""
    near = get_close_matches(name, list(known), n=2, cutoff=0.6)
    return f" Did you mean {' or '.join(repr(n) for n in near)}?" if near else ""
