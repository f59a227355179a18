"""Files that code or parameters name: weights, tables, scripts."""

import re
import shutil
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import Any

from benchnav.source.module import Module, is_library
from benchnav.source.syntax import MAX_LENGTH, references
from benchnav.source.tree import files_below

MAX_MATCHES = 1_000  # files of one pattern
_FILE = re.compile(r"[^\n]*\.\w{1,16}")
_FOLDER = re.compile(r"\.?\w[\w.-]*/?")


def named_by_code(module: Module) -> Iterator[tuple[str, Path]]:
    """Yield (text, file) for every file that a string in the code of ``module`` names.

    A string is relative to the module's folder, to subfolders that other strings name, and, in
    a working copy, to the folder that contains the package.
    """
    texts = references(module.file.read_bytes()).texts
    folders = [module.file.parent]
    if not is_library(module) and module.root not in folders:
        folders.append(module.root)
    for _ in range(3):  # "weights" / "v2" / "best.npz" are three strings
        folders += [
            inner
            for folder in folders
            for text in texts
            if _FOLDER.fullmatch(text) and (inner := folder / text) not in folders
            and inner.is_dir()
        ]  # fmt: skip
    for text in sorted(t for t in texts if _FILE.fullmatch(t)):
        for folder in folders:
            for file in _matches(folder, text):
                yield text, file


def _matches(folder: Path, pattern: str) -> Iterator[Path]:
    """Yield the files that match ``pattern``, relative to ``folder``."""
    if pattern.startswith(("/", "~")):
        absolute = Path(pattern).expanduser()
        found: Iterable[Path] = [absolute]
    elif "*" in pattern and "**" not in pattern:
        found = folder.glob(pattern)
    else:
        found = [folder / pattern]
    for path in islice(found, MAX_MATCHES):
        try:
            if path.is_file():
                yield path
        except OSError:  # for example, the string is too long for a file name
            continue


@dataclass
class NamedFiles:
    """The files that parameters name."""

    files: list[tuple[str, Path]] = field(default_factory=list)  # (name, file)
    scripts: list[Module] = field(default_factory=list)  # Python files; their imports count too
    modules: list[str] = field(default_factory=list)  # names after ``python -m``

    def add(self, path: Path) -> None:
        """Add a file, or all files of a folder."""
        if path.is_dir():
            self.files += [(str(f.relative_to(path)), f) for f in files_below(path)]
        elif path.suffix == ".py":
            self.scripts.append(Module(path.stem, path.absolute(), is_package=False))
        elif path.is_file():  # reading a pipe or a device could block for ever
            self.files.append((path.name, path))


def named_by_parameters(spec: Mapping[str, Any]) -> NamedFiles:
    """Return the files, folders and programs that the parameters of a navigator name."""
    named = NamedFiles()
    for text in texts_of({key: value for key, value in spec.items() if key != "type"}):
        path = _path(text)
        if path is not None and ("/" in text.strip("./") or path.is_file()):
            named.add(path)
    command = spec.get("command")
    if isinstance(command, list | tuple) and command and all(isinstance(c, str) for c in command):
        _add_program(list(command), named)
    return named


def _add_program(command: list[str], named: NamedFiles) -> None:
    """Add the scripts and modules that a command runs, or else the program itself."""
    program, *arguments = command
    flags = [i for i, argument in enumerate(arguments[:-1]) if argument == "-m"]
    named.modules += [arguments[i + 1] for i in flags]
    scripts = [Path(argument) for argument in arguments if Path(argument).is_file()]
    for script in scripts:
        named.add(script)
    found = shutil.which(program)
    if found is not None and not scripts and not flags:
        named.add(Path(found))


def _path(text: str) -> Path | None:
    """Return the existing file or folder that a string names; None if it names none."""
    if not (_FILE.fullmatch(text) or "/" in text) or len(text) > MAX_LENGTH:
        return None
    try:
        path = Path(text).expanduser()
        return path if path.exists() else None
    except (OSError, RuntimeError, ValueError):
        return None


def texts_of(parameters: Any) -> Iterator[str]:
    """Yield every string in parameters, at any depth, without keys."""
    if isinstance(parameters, str):
        yield parameters
    elif isinstance(parameters, Mapping):
        for value in parameters.values():
            yield from texts_of(value)
    elif isinstance(parameters, list | tuple):
        for value in parameters:
            yield from texts_of(value)
