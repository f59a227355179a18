"""The recipes of installed trainers. A trainer of another package is asked in its own process.

So a trainer that hangs, exits or fails to import is reported as broken, and hides no recipe of
another one.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchnav.config.yaml_reader import read_yaml
from benchnav.errors import BenchnavError, PluginConflictError
from benchnav.navigation.plugin.plugin_process import IMPORT, Plugin, Stepping, ask_plugins, tell
from benchnav.plugins import TRAINERS
from benchnav.processes.channel import Channel

_TIMEOUT = 30.0  # [s] for the import of a trainer


@dataclass(frozen=True)
class RecipeFile:
    """A recipe that ships with a trainer."""

    name: str  # "dynamic"
    path: Path
    trainer: str

    @property
    def description(self) -> str:
        """The key `description` of the file; "" where there is none."""
        data = read_yaml(self.path).data
        text = data.get("description", "") if isinstance(data, dict) else ""
        return " ".join(str(text).split())


def recipe_files() -> tuple[dict[str, RecipeFile], dict[str, BenchnavError]]:
    """Return name → recipe, and trainer → error for each trainer that cannot be used.

    Raises PluginConflictError where two trainers ship a recipe of one name.
    """
    found: dict[str, RecipeFile] = {}
    broken: dict[str, BenchnavError] = {}
    for trainer, answer in _answers().items():
        if isinstance(answer, BenchnavError):
            broken[trainer] = answer
            continue
        for path in map(Path, answer):
            if path.stem in found:
                raise PluginConflictError(
                    f"The recipe name {path.stem!r} is claimed more than once:"
                    f" {found[path.stem].path} and {path}. Name the file."
                )
            found[path.stem] = RecipeFile(path.stem, path, trainer)
    return dict(sorted(found.items())), broken


def _answers() -> dict[str, list[str] | BenchnavError]:
    answers: dict[str, list[str] | BenchnavError] = {}
    plugins = []
    for name in TRAINERS.names():
        if TRAINERS.is_local(name):
            answers[name] = _paths(name, lambda step: None)
        else:
            plugins.append(Plugin(TRAINERS.kind, name, "", name))
    asked = ask_plugins(f"{__name__}:tell_recipes", [[plugin] for plugin in plugins], _TIMEOUT)
    for plugin, (answer,) in zip(plugins, asked, strict=True):
        answers[plugin.name] = _checked(plugin, answer)
    return answers


def _checked(plugin: Plugin, answer: Any) -> list[str] | BenchnavError:
    if isinstance(answer, BenchnavError):
        return answer
    if isinstance(answer, list) and all(isinstance(path, str) for path in answer):
        return answer
    return plugin.broken("it did not name its recipes")


def tell_recipes(channel: Channel, notes: "memoryview[float]") -> None:
    """Answer which recipes trainers ship. Runs in a process of its own."""
    tell(channel, notes, _paths)


def _paths(trainer: str, stepping: Stepping) -> list[str]:
    stepping(IMPORT)
    folder = Path(TRAINERS.load(trainer).recipes)
    return [str(path) for path in sorted(folder.glob("*.yaml"))]
