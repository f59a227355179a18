"""The recipes of installed trainers. A trainer of another package is loaded in its own process.

Therefore a trainer that hangs, exits or fails to import is reported as broken, and does not
hide recipes of other trainers.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchnav.config.yaml_reader import read_yaml
from benchnav.errors import BenchnavError, PluginConflictError
from benchnav.navigation.plugin.plugin_process import (
    IMPORT,
    Plugin,
    StepCallback,
    query_plugins,
    serve,
)
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
        """The value of the key `description` of the file; "" if there is none."""
        data = read_yaml(self.path).data
        text = data.get("description", "") if isinstance(data, dict) else ""
        return " ".join(str(text).split())


def recipe_files() -> tuple[dict[str, RecipeFile], dict[str, BenchnavError]]:
    """Return name → recipe, and trainer → error for each trainer that cannot be used.

    Raises PluginConflictError if two trainers have recipes with one name.
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
    replies = query_plugins(f"{__name__}:serve_recipes", [[plugin] for plugin in plugins], _TIMEOUT)
    for plugin, (answer,) in zip(plugins, replies, strict=True):
        answers[plugin.name] = _checked(plugin, answer)
    return answers


def _checked(plugin: Plugin, answer: Any) -> list[str] | BenchnavError:
    if isinstance(answer, BenchnavError):
        return answer
    if isinstance(answer, list) and all(isinstance(path, str) for path in answer):
        return answer
    return plugin.broken("it did not name its recipes")


def serve_recipes(channel: Channel, notes: "memoryview[float]") -> None:
    """Send the recipes of trainers. Runs in a separate process."""
    serve(channel, notes, _paths)


def _paths(trainer: str, on_step: StepCallback) -> list[str]:
    on_step(IMPORT)
    folder = Path(TRAINERS.load(trainer).recipes)
    return [str(path) for path in sorted(folder.glob("*.yaml"))]
