"""A check of this installation: what `benchnav.doctor` returns."""

import platform
import sys
from collections.abc import Iterable, Iterator
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

from benchnav.api.components.kind import Kind
from benchnav.api.components.listing import BROKEN, entries
from benchnav.api.execution.warm import compile_kernels
from benchnav.api.output.text_table import table_html
from benchnav.errors import BenchnavError, MissingExtraError
from benchnav.plugins import CONTROLLERS, METRICS, NAVIGATORS, PLANNERS, TRAINERS
from benchnav.processes.main_module import stop_import_of_main
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
    "view": {"matplotlib": "matplotlib"},
    "video": {"imageio-ffmpeg": "imageio_ffmpeg"},
    "mcap": {
        "mcap": "mcap",
        "mcap-protobuf-support": "mcap_protobuf",
        "foxglove-schemas-protobuf": "foxglove_schemas_protobuf",
    },
    "report": {"itables": "itables", "Jinja2": "jinja2", "plotly": "plotly"},
    "rerun": {"rerun-sdk": "rerun"},
    "ray": {"ray": "ray"},
}  # extra → package → module


class Check(NamedTuple):
    """One line of a diagnosis."""

    verdict: str  # OK, MISSING or WRONG
    subject: str
    detail: str


OK, MISSING, WRONG = "ok", "-", "WRONG"


class Diagnosis:
    """The result of checking an installation; true in a condition if nothing is wrong."""

    def __init__(self, checks: Iterable[Check]) -> None:
        self.checks = tuple(checks)

    @property
    def healthy(self) -> bool:
        """Whether nothing is wrong. A missing extra is not wrong."""
        return not any(check.verdict == WRONG for check in self.checks)

    def text(self) -> str:
        """Return the checks as lines, as ``benchnav doctor`` prints them."""
        return columns(self.checks)

    def __bool__(self) -> bool:
        return self.healthy

    def __repr__(self) -> str:
        return self.text()

    def _repr_html_(self) -> str:
        return table_html("Installation", Check._fields, self.checks)


def doctor(*, warm: bool = False, quiet: bool = False) -> Diagnosis:
    """Check this installation: versions, cores, the user's folders, extras and plugins.

    Args:
        warm: first compile the kernels, so that no run waits for it; takes a minute, once.
        quiet: print no progress of it.
    """
    stop_import_of_main()
    if warm:
        compile_kernels(quiet=quiet)
    return Diagnosis([*_machine(), *_packages(), *_cache(), *_receipts(), *_plugins()])


def _machine() -> Iterator[Check]:
    yield Check(OK, "python", f"{platform.python_version()} ({sys.executable})")
    yield Check(OK, "machine", platform.platform())
    cores = core_count()
    yield Check(OK, "cores", f"{cores}, so `benchnav run` uses {counted(cores, 'worker')}")


def _packages() -> Iterator[Check]:
    for name in _CORE:
        try:
            yield Check(OK, name, version(name))
        except PackageNotFoundError:
            yield Check(WRONG, name, "must be installed: pip install benchnav")
    for extra, packages in _EXTRAS.items():
        absent = [name for name, module in packages.items() if find_spec(module) is None]
        have = [f"{name} {version(name)}" for name in packages if name not in absent]
        if absent:
            detail = f"without {', '.join(absent)}: pip install 'benchnav[{extra}]'"
            yield Check(MISSING, f"extra [{extra}]", detail)
        else:
            yield Check(OK, f"extra [{extra}]", ", ".join(have))


def _cache() -> Iterator[Check]:
    """Yield the folder of compiled kernels: a first run compiles them, later runs load them."""
    from benchnav.kernels import cache_base, kernels_name

    base = cache_base()
    if base.path is None:
        cure = "set NUMBA_CACHE_DIR to a folder that you can write"
        yield Check(
            WRONG, "kernel cache", f"none, so every command compiles: {base.reason}; {cure}"
        )
    else:
        yield _folder("kernel cache", base.path / kernels_name("benchnav"), base.reason)


def _receipts() -> Iterator[Check]:
    """Yield the folder of receipts, which `verify` writes and leaderboards read."""
    state = user_state()
    if state.path is None:
        cure = "set XDG_STATE_HOME to a folder that you can write"
        yield Check(WRONG, "receipts", f"none can be kept: {state.reason}; {cure}")
    else:
        yield _folder("receipts", state.path / "verified", state.reason)


def _folder(name: str, place: Path, reason: str) -> Check:
    if reason:
        return Check(MISSING, name, f"{place}, because {reason}")
    return Check(OK, name, str(place))


def _plugins() -> Iterator[Check]:
    from benchnav.api.components.inspection import MADE, inspect_plugins

    for registry in (NAVIGATORS, PLANNERS, CONTROLLERS, METRICS, TRAINERS):
        answers = inspect_plugins(registry, registry.names(), MADE)
        errors = {n: e for n, e in answers.items() if isinstance(e, BenchnavError)}
        incomplete = {n: str(e) for n, e in errors.items() if isinstance(e, MissingExtraError)}
        yield Check(OK, f"{registry.kind}s", f"{len(answers) - len(errors)} can be used")
        for cause in dict.fromkeys(incomplete.values()):
            names = ", ".join(name for name, why in incomplete.items() if why == cause)
            yield Check(MISSING, f"{registry.kind}s", f"without {names}. {cause}")
        for name, error in errors.items():
            if name not in incomplete:
                yield Check(WRONG, registry.kind, str(error))
    robots = list(entries(Kind.ROBOTS))
    wrong = [each for each in robots if each.origin == BROKEN]
    yield Check(OK, "robots", f"{len(robots) - len(wrong)} can be used")
    for each in wrong:
        yield Check(WRONG, "robot", f"{each.name}: {each.description}")
