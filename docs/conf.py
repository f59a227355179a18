"""Configuration of the documentation site (Sphinx): `make docs` builds it into build/site."""

import os
import re
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx

import benchnav

project = "benchnav"
author = "The benchnav authors"
version = release = benchnav.__version__
html_title = f"benchnav {version}"

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_copybutton"]
root_doc = "index"
exclude_patterns = ["learning"]
source_suffix = {".md": "markdown"}

myst_heading_anchors = 3
myst_enable_extensions = ["colon_fence"]

autodoc_member_order = "bysource"
autodoc_typehints = "none"  # signatures show what matters, and docstrings name shapes and units
autodoc_class_signature = "separated"
autodoc_default_options = {"exclude-members": "__init__"}  # records list their fields one by one
autodoc_preserve_defaults = True
autoclass_content = "class"
default_role = "code"  # `name` in a docstring is code, as in Markdown
napoleon_google_docstring = True
napoleon_numpy_docstring = False

html_theme = "pydata_sphinx_theme"
REPLAY = "../benchnav/viewer/replay"
html_static_path = ["_static", f"{REPLAY}/replay.js", f"{REPLAY}/replay.css"]  # for _static/replays
html_css_files = ["site.css"]
html_copy_source = False
html_show_sourcelink = False
html_theme_options = {
    "logo": {"text": "benchnav"},
    "navbar_align": "left",
    "header_links_before_dropdown": 6,
    "navbar_end": ["theme-switcher"],
    "footer_start": ["copyright"],
    "footer_end": ["theme-version"],
    "show_prev_next": True,
    "navigation_depth": 2,
    "show_toc_level": 2,
}
html_sidebars: dict[str, list[str]] = {"index": [], "gallery": []}
copyright = "The benchnav authors, Apache-2.0"

LISTS = (
    "components/README",
    "decisions/README",
    "formats/README",
)  # pages that list the other pages of their folder
CARDS = "baselines/learned/recurrent_ppo/weights"
SHOWN = {  # page of the site: file of the project that it shows
    "changelog": "CHANGELOG.md",
    "contributing": "CONTRIBUTING.md",
    "guides/c-navigator": "examples/c_navigator/README.md",
    "guides/ros2": "examples/ros2_controller/README.md",
    "results/model-card-recurrent-ppo": f"{CARDS}/recurrent-ppo.md",
    "results/model-card-recurrent-ppo-plus": f"{CARDS}/recurrent-ppo-plus.md",
}
DOCS = Path(__file__).parent
PAGES = {DOCS.parent / file: DOCS / f"{page}.md" for page, file in SHOWN.items()}
LINK = re.compile(r"(?<=\]\()(?!https?:|#)([^)#\s]+)")


def setup(app: Sphinx) -> None:
    """Connect the handlers that prepare the text of pages and docstrings."""
    app.connect("source-read", _prepare)
    app.connect("autodoc-process-docstring", _adapt, priority=400)  # before napoleon
    app.connect("build-finished", _add_reports)


def _add_reports(app: Sphinx, error: Exception | None) -> None:
    """Unpack the reports of docs/leaderboard beside the pages that name them."""
    if error is not None or app.builder.format != "html":
        return
    from studies.reference_run import unpack_report

    for archive in DOCS.glob("leaderboard/*-report.tar.xz"):
        unpack_report(archive, Path(app.outdir, "leaderboard"))


def _adapt(app: Sphinx, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Leave out docstrings of modules, whose pages have a text of their own; keep colons.

    Napoleon reads the text of an attribute before a colon as its type.
    """
    if what == "module":
        lines.clear()
    elif what in ("attribute", "property") and lines:
        lines[0] = lines[0].replace(": ", " – ")


def _prepare(app: Sphinx, name: str, source: list[str]) -> None:
    """Show files from outside of docs/, point links at their pages, and add lists of folders."""
    page = DOCS / f"{name}.md"
    file = DOCS.parent / SHOWN[name] if name in SHOWN else page
    if name in SHOWN:
        source[0] = file.read_text(encoding="utf-8")
        app.env.note_dependency(str(file))
    source[0] = LINK.sub(lambda link: _target(link[0], file.parent, page.parent), source[0])
    if name in LISTS:
        source[0] += "\n:::{toctree}\n:hidden:\n:glob:\n\n*\n:::\n"


def _target(link: str, here: Path, there: Path) -> str:
    """Return a link of a file in the folder `here` as a page in the folder `there` writes it."""
    path = Path(os.path.normpath(here / link))
    if not path.exists():
        return link
    return Path(os.path.relpath(PAGES.get(path, path), there)).as_posix()
