"""The JavaScript and style files that all pages of a report share."""

from __future__ import annotations

import base64
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path

from benchnav.errors import MissingExtraError
from benchnav.viewer.replay.page import ASSETS as REPLAY_ASSETS
from benchnav.viewer.replay.page import asset as replay_asset

PLOTLY = ("plotly", "package_data/plotly.min.js")
LIBRARIES = ("plotly.min.js", "datatables.js")  # the files that they become
DATATABLES = ("itables", "html/dt_bundle.js")


def require_libraries() -> None:
    """Raise MissingExtraError if a library of the extra "report" is not installed."""
    if find_spec("jinja2") is None:
        raise MissingExtraError("A report", "report")
    for package, name in (PLOTLY, DATATABLES):
        _library(package, name)


def write_assets(folder: Path) -> None:
    """Write all shared files into ``folder``. Raises OSError if the disk refuses."""
    folder.mkdir()
    for path in (files("benchnav.report") / "assets").iterdir():
        (folder / path.name).write_bytes(path.read_bytes())
    for name in REPLAY_ASSETS:
        (folder / name).write_text(replay_asset(name), encoding="utf-8")
    write_libraries(folder)


def write_libraries(folder: Path) -> None:
    """Write the files of libraries, `LIBRARIES`, into ``folder``.

    Raises OSError if the disk refuses.
    """
    (folder / "plotly.min.js").write_bytes(_library(*PLOTLY).read_bytes())
    # Browsers refuse to import a module from disk, but they import one from a data address.
    module = base64.b64encode(_library(*DATATABLES).read_bytes()).decode("ascii")
    text = f'window.dataTablesModule = "data:text/javascript;base64,{module}";\n'
    (folder / "datatables.js").write_text(text, encoding="ascii")


def _library(package: str, name: str) -> Path:
    """Return a file of an installed package, without importing the package."""
    found = find_spec(package)
    for place in (found.submodule_search_locations or ()) if found else ():
        path = Path(place, name)
        if path.is_file():
            return path
    raise MissingExtraError("A report", "report")
