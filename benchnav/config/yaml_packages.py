"""Scenario, suite and robot files of installed packages.

A package is named by an entry point, ``mine = "my_scenarios"``, in the group
`benchnav.scenarios`, `benchnav.suites` or `benchnav.robots`. Its folder holds
``<family>/<name>.yaml``, ``suites/<name>.yaml`` and ``<robot>.yaml``. The folder is found without
importing the package: only data is read.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from benchnav.errors import PluginConflictError
from benchnav.plugins import ROBOTS, SCENARIOS, SUITES, Registry

SUFFIXES = (".yaml", ".yml")
_SUITES = "suites"  # the folder that is no family of scenarios


@dataclass(frozen=True)
class YamlFile:
    """A file of an installed package."""

    name: str  # "trap/u", "quick" or "jackal"
    path: Path
    distribution: str  # "benchnav 0.1.0"


def scenario_files() -> dict[str, list[YamlFile]]:
    """Return name → files of every installed scenario; more than one file is a conflict."""
    return _by_name(
        YamlFile(f"{family.name}/{file.stem}", file, distribution)
        for folder, distribution in _folders(SCENARIOS)
        for family in folder.iterdir()
        if family.is_dir() and family.name != _SUITES and not family.name.startswith(("_", "."))
        for file in _yaml(family)
    )


def suite_files() -> dict[str, list[YamlFile]]:
    """Return name → files of every installed suite; more than one file is a conflict."""
    return _by_name(
        YamlFile(file.stem, file, distribution)
        for folder, distribution in _folders(SUITES)
        if (folder / _SUITES).is_dir()
        for file in _yaml(folder / _SUITES)
    )


def robot_files() -> dict[str, list[YamlFile]]:
    """Return name → files of every installed robot; more than one file is a conflict."""
    return _by_name(
        YamlFile(file.stem, file, distribution)
        for folder, distribution in _folders(ROBOTS)
        for file in _yaml(folder)
    )


def only(kind: str, files: list[YamlFile]) -> YamlFile:
    """Return the one file of a name. Raises PluginConflictError where there are several."""
    if len(files) > 1:
        claims = " and ".join(f"{file.distribution} ({file.path})" for file in files)
        raise PluginConflictError(
            f"The {kind} name {files[0].name!r} is claimed more than once: {claims}."
            " Uninstall one, or name its file."
        )
    return files[0]


def missing_packages(registry: Registry) -> Iterator[tuple[str, str]]:
    """Yield (package, cause) for each entry point whose package is not there."""
    for source in registry.sources():
        if not _locations(source.value):
            yield (
                source.value,
                f"There is no package {source.value!r}, which {source.distribution} names in its"
                f" entry points ({registry.group}).",
            )


def _folders(registry: Registry) -> Iterator[tuple[Path, str]]:
    for source in registry.sources():
        for location in _locations(source.value):
            yield location, source.distribution


def _locations(package: str) -> list[Path]:
    """The folders of a package. Only its top-level name is looked up, which imports nothing."""
    top, *inner = package.split(".")
    spec = find_spec(top)
    if spec is None or spec.submodule_search_locations is None:
        return []
    folders = (Path(place).joinpath(*inner) for place in spec.submodule_search_locations)
    return [folder for folder in folders if folder.is_dir()]


def _yaml(folder: Path) -> Iterator[Path]:
    return (file for file in sorted(folder.iterdir()) if file.suffix in SUFFIXES)


def _by_name(files: Iterator[YamlFile]) -> dict[str, list[YamlFile]]:
    found: dict[str, list[YamlFile]] = {}
    for file in files:
        found.setdefault(file.name, []).append(file)
    return dict(sorted(found.items()))
