"""`benchnav show`: one component by name, with its parameters, units and source."""

from collections.abc import Iterator
from typing import Annotated

import typer

from benchnav.api.components.scenario_page import scenario_page
from benchnav.cli.console import put
from benchnav.cli.viewing.list import REGISTRIES, Kind
from benchnav.errors import BenchnavError, UsageError, did_you_mean
from benchnav.navigation.hierarchy.composition import is_pair
from benchnav.plugins import NAVIGATORS, TRAINERS
from benchnav.text.columns import columns


def show(
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="Any name that `benchnav list` prints.")
    ],
) -> None:
    """Show a component by name.

    Purpose, parameters with units and defaults, and source.
    """
    from benchnav.api.components.inspection import PAGE, inspect_plugins

    blocks = [
        _shown(inspect_plugins(registry, [name], PAGE)[name])
        for kind, registry in REGISTRIES.items()
        if name in registry.names()
        or (kind == Kind.NAVIGATORS and _is_class(name) and not is_pair(name))
    ]
    blocks += [*_pair(name), *_scenario(name), *_suite(name)]
    blocks = blocks or [*_recipe(name)]
    if not blocks:
        raise UsageError(
            f"NAME must be something that 'benchnav list' lists. Got {name!r} instead."
            f"{did_you_mean(name, _everything())}"
        )
    put("\n\n".join(blocks))


def _shown(page: "str | BenchnavError") -> str:
    if isinstance(page, BenchnavError):
        raise page
    return page


def _pair(name: str) -> Iterator[str]:
    """Yield the page of a navigator that is named by its parts."""
    from benchnav.api.components.inspection import PAIR, inspect_plugins

    if is_pair(name):
        yield _shown(inspect_plugins(NAVIGATORS, [name], PAIR)[name])


def _is_class(name: str) -> bool:
    """Whether a name is ``module:Class``, and not a scenario with parameters after a colon."""
    return ":" in name and "=" not in name


def _scenario(name: str) -> Iterator[str]:
    from benchnav.scenario.catalogue import find, is_named

    if is_named(name):
        yield scenario_page(find(name))


def _suite(name: str) -> Iterator[str]:
    from benchnav.runner.plan.suite import load_suite
    from benchnav.runner.plan.suite_file import suite_names

    if name not in suite_names():
        return
    suite = load_suite(name)
    facts = [
        ("is", "a suite"),
        ("scenarios", ", ".join(s.identity for s in suite.scenarios)),
        ("tracks", ", ".join(suite.tracks)),
        ("navigators", ", ".join(e.label for e in suite.entries)),
        ("seeds", f"{suite.seeds.start} … {suite.seeds.stop - 1} of split {suite.split}"),
    ]
    yield f"{suite.name}@{suite.version}\n" + columns([("  " + k, v) for k, v in facts])


def _recipe(name: str) -> Iterator[str]:
    from benchnav.envs.recipes import recipe_files

    recipe = recipe_files()[0].get(name)
    if recipe is None:
        return
    facts = [
        ("is", f"a recipe of the trainer {recipe.trainer}: {recipe.description}"),
        ("comes from", f"{TRAINERS.source(recipe.trainer).distribution}, {recipe.path}"),
        ("use it", f"benchnav train {name}"),
    ]
    head = f"{name}\n" + columns([("  " + k, v) for k, v in facts])
    text = recipe.path.read_text(encoding="utf-8").rstrip()
    yield "\n".join([head, "  file", *(f"    {line}" for line in text.splitlines())])


def _everything() -> list[str]:
    from benchnav.envs.recipes import recipe_files
    from benchnav.runner.plan.suite_file import suite_names
    from benchnav.scenario.catalogue import names

    plugins = [name for registry in REGISTRIES.values() for name in registry.names()]
    return [*plugins, *names(), *suite_names(), *recipe_files()[0]]
