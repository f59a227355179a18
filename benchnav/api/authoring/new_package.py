"""Write templates of plugin packages."""

import re
from collections.abc import Callable, Mapping
from os import PathLike
from pathlib import Path

from benchnav.api.authoring.free_name import free_name, name_taken
from benchnav.api.authoring.plugin_templates import (
    controller_package,
    metric_package,
    navigator_package,
    planner_package,
    scenario_package,
)
from benchnav.errors import UsageError, did_you_mean
from benchnav.plugins import CONTROLLERS, METRICS, NAVIGATORS, PLANNERS, SCENARIOS, Registry
from benchnav.processes.main_module import stop_import_of_main
from benchnav.system.plain_file import writing

KINDS: Mapping[str, tuple[Registry, Callable[[str], dict[str, str]]]] = {
    "navigator": (NAVIGATORS, navigator_package),
    "planner": (PLANNERS, planner_package),
    "controller": (CONTROLLERS, controller_package),
    "metric": (METRICS, metric_package),
    "scenario-pack": (SCENARIOS, scenario_package),
}


def new_package(kind: str, name: str, folder: "str | PathLike[str] | None" = None) -> Path:
    """Write a complete plugin package, and return its folder.

    It has code or scenarios, an entry point, a test that passes and a README, and can be installed
    and run as it is.

    Args:
        kind: navigator, planner, controller, metric or scenario-pack.
        name: of the plugin and the package: small letters, digits and single hyphens.
        folder: missing or empty; None: the name, in the working directory.

    Raises UsageError for a kind, name or folder that is not possible, and StoreError where the
    folder cannot be written.
    """
    stop_import_of_main()
    if kind not in KINDS:
        raise UsageError(
            f"The kind must be one of {', '.join(KINDS)}. Got {kind!r} instead."
            f"{did_you_mean(kind, KINDS)}"
        )
    registry, package = KINDS[kind]
    if not re.fullmatch(r"[a-z][a-z0-9]*(-[a-z0-9]+)*", name):
        raise UsageError(
            "The name must be small letters, digits and single hyphens, a letter first."
            f" Got {name!r} instead."
        )
    if taken := name_taken(name, registry):
        raise UsageError(f"The name must be free. {taken}. {free_name(name, registry)!r} is free.")
    target = Path(name if folder is None else folder)
    if target.exists() and (not target.is_dir() or any(target.iterdir())):
        raise UsageError(f"{target} must be missing or an empty folder. It is not empty.")
    for file, text in package(name).items():
        with writing(target / file):
            (target / file).parent.mkdir(parents=True, exist_ok=True)
            (target / file).write_text(text, encoding="utf-8")
    return target


def new_navigator(name: str, folder: "str | PathLike[str] | None" = None) -> Path:
    """Write a complete navigator package, and return its folder, as `new_package` does.

    Args:
        name: of the navigator and the package: small letters, digits and single hyphens.
        folder: missing or empty; None: the name, in the working directory.

    Raises UsageError for a name or folder that is not possible, and StoreError where the folder
    cannot be written.
    """
    return new_package("navigator", name, folder)
