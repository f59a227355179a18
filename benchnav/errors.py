"""The exception tree. Every error that a user can cause derives from one class.

BenchnavError
├── UsageError               a wrong option, name or combination (exit status 2)
├── InputError               a wrong file; the text names file:line:key (exit status 2)
│   ├── ScenarioError        a scenario, suite or recipe file
│   ├── MapError             an occupancy map, a .scen file
│   ├── MeshError            a mesh
│   ├── WorldFileError       an SDF world, a WKT geometry, a picture
│   └── TrajectoryError      a table of trajectories
├── UnsolvableError          a scenario that cannot be drawn
├── PluginError              a navigator, planner, controller, metric or scenario plugin
│   ├── UnknownPluginError   unknown name (the message lists the nearest names)
│   ├── PluginConflictError  two distributions claim one name (the message names both)
│   ├── BrokenPluginError    the plugin fails to import (the message gives the cause)
│   └── ConfigError          the plugin's Config refuses the parameters
├── MissingExtraError        an optional dependency is missing (the message gives the pip line)
├── TrainingError            training failed: a number is not finite
├── NavigatorError           a navigator raised, returned garbage, or broke its contract
└── StoreError               wrong data on disk
    ├── NoRunError           no run at the given path (exit status 2)
    ├── RunConflictError     the folder holds another suite's run, or another process writes it
    └── CorruptPartError     a part is truncated, changed or missing
        └── ForeignRowError  a part holds rows of another cell or seed

Every message contains, in this order: what is wrong, what is allowed, what was given, where; then
the cure.
"""

from collections.abc import Iterable
from difflib import get_close_matches


class BenchnavError(Exception):
    """Base class of all errors that benchnav raises on purpose."""


class UsageError(BenchnavError):
    """The request is not possible: a wrong option, name or combination."""


class InputError(BenchnavError):
    """A file has a content that is not allowed."""


class ScenarioError(InputError):
    """A scenario or suite file is wrong."""


class MapError(InputError):
    """An occupancy map or its companion file is wrong."""


class MeshError(InputError):
    """A mesh file is wrong."""


class WorldFileError(InputError):
    """A file that describes a world is wrong."""


class TrajectoryError(InputError):
    """A table of trajectories is wrong."""


class UnsolvableError(BenchnavError):
    """A scenario whose worlds cannot be drawn or cannot be solved."""


class PluginError(BenchnavError):
    """A plugin cannot be used."""


class UnknownPluginError(PluginError):
    """No plugin has the given name."""


class PluginConflictError(PluginError):
    """Two distributions claim one name."""


class BrokenPluginError(PluginError):
    """A plugin fails to import."""


class ConfigError(PluginError):
    """A plugin's Config refuses its parameters."""


class MissingExtraError(BenchnavError):
    """An optional dependency is not installed."""

    def __init__(self, feature: str, extra: str) -> None:
        super().__init__(f"{feature} needs an extra: pip install 'benchnav[{extra}]'")


class TrainingError(BenchnavError):
    """Training failed; the result so far is kept."""


class NavigatorError(BenchnavError):
    """A navigator raised, or returned something that is not a command."""


class StoreError(BenchnavError):
    """Something on disk is wrong."""


class NoRunError(StoreError):
    """There is no run at the given path."""


class RunConflictError(StoreError):
    """The run folder belongs to another run or process."""


class CorruptPartError(StoreError):
    """A part of a run cannot be trusted."""


class ForeignRowError(CorruptPartError):
    """A part holds rows of another cell, or of a seed that the cell does not have."""


def named(name: str, text: str) -> BenchnavError:
    """Return the error class ``name`` with this text, as another process reported it."""
    kind = globals().get(name)
    if not (isinstance(kind, type) and issubclass(kind, BenchnavError)):
        kind = BenchnavError
    error: BenchnavError = kind.__new__(kind)
    error.args = (text,)
    return error


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return ``" Did you mean 'x' or 'y'?"`` for the nearest known names, or ``""``."""
    near = get_close_matches(name, list(known), n=2, cutoff=0.6)
    return f" Did you mean {' or '.join(repr(n) for n in near)}?" if near else ""
