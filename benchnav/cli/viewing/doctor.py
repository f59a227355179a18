"""`benchnav doctor`: check this installation."""

import platform
import sys
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path

import typer

from benchnav.cli.console import put
from benchnav.errors import BenchnavError, MissingExtraError
from benchnav.plugins import CONTROLLERS, METRICS, NAVIGATORS, PLANNERS, TRAINERS
from benchnav.system.user_folders import user_state
from benchnav.text.columns import columns
from benchnav.text.plural import counted
from benchnav.threads import core_count

_CORE = ("benchnav", "numpy", "numba", "scipy", "shapely", "pyarrow", "pydantic", "pedpy")
_EXTRAS = {
    "plan": {
        "ompl": "ompl",
        "trimesh": "trimesh",
        "python-fcl": "fcl",
        "pycollada": "collada",
        "networkx": "networkx",
        "mapbox-earcut": "mapbox_earcut",
    },
    "learn": {
        "torch": "torch",
        "stable-baselines3": "stable_baselines3",
        "sb3-contrib": "sb3_contrib",
        "gymnasium": "gymnasium",
        "pettingzoo": "pettingzoo",
        "tensorboard": "tensorboard",
    },
    "view": {"matplotlib": "matplotlib", "plotly": "plotly"},
    "ray": {"ray": "ray"},
}  # extra → package → module
Line = tuple[str, str, str]  # verdict, subject, detail


def doctor() -> None:
    """Check this installation.

    It checks versions, cores, the user's folders, extras and plugins.
    """
    lines = [*_machine(), *_packages(), *_cache(), *_receipts(), *_plugins()]
    put(columns(lines))
    if any(verdict == "WRONG" for verdict, _, _ in lines):
        raise typer.Exit(1)


def _machine() -> Iterator[Line]:
    yield "ok", "python", f"{platform.python_version()} ({sys.executable})"
    yield "ok", "machine", platform.platform()
    cores = core_count()
    yield "ok", "cores", f"{cores}, so `benchnav run` uses {counted(cores, 'worker')}"


def _packages() -> Iterator[Line]:
    for name in _CORE:
        try:
            yield "ok", name, version(name)
        except PackageNotFoundError:
            yield "WRONG", name, "must be installed: pip install benchnav"
    for extra, packages in _EXTRAS.items():
        absent = [name for name, module in packages.items() if find_spec(module) is None]
        have = [f"{name} {version(name)}" for name in packages if name not in absent]
        if absent:
            detail = f"without {', '.join(absent)}: pip install 'benchnav[{extra}]'"
            yield "-", f"extra [{extra}]", detail
        else:
            yield "ok", f"extra [{extra}]", ", ".join(have)


def _cache() -> Iterator[Line]:
    """Yield the folder of compiled kernels: a first run compiles them, later runs load them."""
    from benchnav.kernels import cache_base, kernels_name

    base = cache_base()
    if base.path is None:
        cure = "set NUMBA_CACHE_DIR to a folder that you can write"
        yield "WRONG", "kernel cache", f"none, so every command compiles: {base.reason}; {cure}"
    else:
        yield _folder("kernel cache", base.path / kernels_name("benchnav"), base.reason)


def _receipts() -> Iterator[Line]:
    """Yield the folder of receipts, which `verify` writes and leaderboards read."""
    state = user_state()
    if state.path is None:
        cure = "set XDG_STATE_HOME to a folder that you can write"
        yield "WRONG", "receipts", f"none can be kept: {state.reason}; {cure}"
    else:
        yield _folder("receipts", state.path / "verified", state.reason)


def _folder(name: str, place: Path, reason: str) -> Line:
    return ("-", name, f"{place}, because {reason}") if reason else ("ok", name, str(place))


def _plugins() -> Iterator[Line]:
    from benchnav.api.components.inspection import MADE, inspect_plugins

    for registry in (NAVIGATORS, PLANNERS, CONTROLLERS, METRICS, TRAINERS):
        answers = inspect_plugins(registry, registry.names(), MADE)
        errors = {n: e for n, e in answers.items() if isinstance(e, BenchnavError)}
        incomplete = {n: str(e) for n, e in errors.items() if isinstance(e, MissingExtraError)}
        yield "ok", f"{registry.kind}s", f"{len(answers) - len(errors)} can be used"
        for cause in dict.fromkeys(incomplete.values()):
            names = ", ".join(name for name, why in incomplete.items() if why == cause)
            yield "-", f"{registry.kind}s", f"without {names}. {cause}"
        for name, error in errors.items():
            if name not in incomplete:
                yield "WRONG", registry.kind, str(error)
