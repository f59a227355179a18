"""Write a scenario file and copies of its maps into one complete folder."""

import itertools
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml

from benchnav.config.yaml_reader import read_yaml
from benchnav.errors import ScenarioError, UsageError
from benchnav.scenario.importers import ros_map
from benchnav.scenario.importers.grid import read_bytes

Mapping = dict[str, Any]

_MAX_BYTES = 1 << 28  # of a map file


def write_scenario(
    mapping: Mapping, out: Path | str, force: bool = False, recording: bytes | None = None
) -> list[Path]:
    """Write a scenario as YAML, and copy its maps into the same folder.

    ``recording`` is the content of the file that the key ``recording`` names.

    If another file has a map's name, the copy gets a new name: no map is ever
    overwritten, because other scenarios may need it.

    Returns the paths of all files, the scenario first.

    Raises:
        UsageError: the scenario exists already and ``force`` is not given, or another
            file has its name, or it cannot be written.
        MapError: a map cannot be read any more.
    """
    out = Path(out)
    try:
        contents = _contents(mapping, out, recording)
        if out.exists() and not force:
            raise UsageError(f"{out} must not exist yet; the option 'force' overwrites it.")
        if out.is_file() and not _is_scenario(out):
            raise UsageError(f"{out} is not a scenario; give the new scenario another name.")
        out.parent.mkdir(parents=True, exist_ok=True)
        for path, content in contents.items():
            if not _holds(path, content):
                path.write_bytes(content)
    except OSError as error:
        raise UsageError(f"{out.parent} is not writable: {error.strerror or error}.") from None
    return list(contents)


def _contents(mapping: Mapping, out: Path, recording: bytes | None) -> dict[Path, bytes]:
    """Return the content of each file, the scenario first."""
    copies = _Copies(out)
    walls = [dict(wall) for wall in mapping.get("walls", [])]
    for wall in walls:
        shape = wall["shape"]
        if "file" in shape:
            name = copies.add_map(Path(shape["file"]), shape.get("format", shape["type"]))
            wall["shape"] = {**shape, "file": name}
    scenario = {**mapping, "walls": walls} if walls else dict(mapping)
    if recording is not None:
        people = scenario["recording"]
        name = copies.add(Path(people["file"]), recording)
        scenario["recording"] = {**people, "file": name}
    text = yaml.safe_dump(scenario, sort_keys=False, default_flow_style=None, allow_unicode=True)
    return {out: text.encode(), **dict(reversed(copies.contents.items()))}


class _Copies:
    """The files to write with a scenario file."""

    def __init__(self, out: Path) -> None:
        self.out = out
        self.contents: dict[Path, bytes] = {}

    def add_map(self, source: Path, format: str) -> str:
        """Add a map with its image, or a mesh; return its name in the folder."""
        if format == "ros":
            document, spec = ros_map.read_header(source)
            image = ros_map.image_path(document, spec)
            name = self.add(image, read_bytes(image, _MAX_BYTES, "the image"))
            if spec.image != name:
                renamed = {**document.data, "image": name}
                text = yaml.safe_dump(renamed, sort_keys=False, default_flow_style=None)
                return self.add(source, text.encode())
        return self.add(source, read_bytes(source, _MAX_BYTES, "the map"))

    def add(self, source: Path, content: bytes) -> str:
        """Add a file under the first free name."""
        if self.out.exists() and source.exists() and self.out.samefile(source):
            raise UsageError(f"{self.out} is the map's own name; give the scenario another name.")
        name = next(n for n in _names(source, self.out) if self._free(n, content))
        self.contents[self.out.parent / name] = content
        return name

    def _free(self, name: str, content: bytes) -> bool:
        path = self.out.parent / name
        if path == self.out or self.contents.get(path, content) != content:
            return False
        return not path.exists() or _holds(path, content)


def _names(source: Path, out: Path) -> Iterator[str]:
    stem = f"{out.stem}-{source.stem if source.stem != out.stem else 'map'}"
    yield source.name
    yield f"{stem}{source.suffix}"
    for number in itertools.count(2):
        yield f"{stem}-{number}{source.suffix}"


def _is_scenario(path: Path) -> bool:
    """Whether a scenario may overwrite a file: it is a scenario already."""
    try:
        data: Any = read_yaml(path).data
    except ScenarioError:
        return False
    return isinstance(data, dict) and "teams" in data


def _holds(path: Path, content: bytes) -> bool:
    """Whether a file exists with exactly this content."""
    try:
        return path.stat().st_size == len(content) and path.read_bytes() == content
    except OSError:
        return False
