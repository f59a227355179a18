"""The page of a component: its purpose, its parameters with units and defaults, its source."""

from collections.abc import Iterator
from html import escape
from os import PathLike

from benchnav.api.components.inspection import PAGE, PAIR, inspect_plugins
from benchnav.api.components.kind import REGISTRIES, Kind
from benchnav.api.components.listing import names
from benchnav.api.components.robot_page import describes_robot, robot_page
from benchnav.api.components.scenario_page import scenario_page
from benchnav.errors import BenchnavError, UsageError, did_you_mean
from benchnav.navigation.hierarchy.composition import is_pair
from benchnav.plugins import NAVIGATORS, TRAINERS
from benchnav.processes.main_module import stop_import_of_main
from benchnav.text.columns import columns


class Page:
    """The description of a component as text, as ``benchnav show`` prints it."""

    def __init__(self, name: str, text: str) -> None:
        self.name = name
        self.text = text

    def __repr__(self) -> str:
        return self.text

    def _repr_html_(self) -> str:
        return f"<pre>{escape(self.text)}</pre>"


def show(name: "str | PathLike[str]") -> Page:
    """Return the page of a component: purpose, parameters with units and defaults, source.

    Args:
        name: of any component that ``benchnav.available()`` has, ``PLANNER+CONTROLLER``,
            ``module:Class``, or the file of a scenario or robot. Components of different kinds that
            share a name are described one after another.

    Raises UsageError where there is no such component, and BrokenPluginError where it cannot be
    used.
    """
    stop_import_of_main()
    name = str(name)
    blocks = [
        _page(inspect_plugins(registry, [name], PAGE)[name])
        for kind, registry in REGISTRIES.items()
        if name in registry.names()
        or (kind == Kind.NAVIGATORS and _is_class(name) and not is_pair(name))
    ]
    blocks += [*_pair(name), *_scenario(name), *_robot(name), *_suite(name)]
    blocks = blocks or [*_recipe(name)]
    if not blocks:
        known = dict.fromkeys(each for kind in Kind for each in names(kind))
        raise UsageError(
            f"There is no component {name!r}.{did_you_mean(name, known)}"
            " 'benchnav list' shows all (in Python: benchnav.available)."
        )
    return Page(name, "\n\n".join(blocks))


def _page(page: str | BenchnavError) -> str:
    if isinstance(page, BenchnavError):
        raise page
    return page


def _pair(name: str) -> Iterator[str]:
    """Yield the page of a navigator that is named by its parts."""
    if is_pair(name):
        yield _page(inspect_plugins(NAVIGATORS, [name], PAIR)[name])


def _is_class(name: str) -> bool:
    """Whether a name is ``module:Class``, and not a scenario with parameters after a colon."""
    return ":" in name and "=" not in name


def _scenario(name: str) -> Iterator[str]:
    from benchnav.scenario.catalogue import find, is_named

    if is_named(name) and not describes_robot(name):
        yield scenario_page(find(name))


def _robot(name: str) -> Iterator[str]:
    from benchnav.scenario.robots.registry import names

    if name in names() or describes_robot(name):
        yield robot_page(name)


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
        ("perception", ", ".join(suite.perceptions)),
        ("navigators", ", ".join(each.label for each in suite.contestants)),
        ("seeds", f"{suite.seeds.start} … {suite.seeds.stop - 1} of split {suite.split}"),
        *([("undisturbed", "each world also without the robots")] if suite.undisturbed else []),
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
