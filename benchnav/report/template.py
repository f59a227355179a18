"""HTML from templates, in which all text is escaped."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

from benchnav.errors import MissingExtraError
from benchnav.text.visible import visible

if TYPE_CHECKING:
    from jinja2 import Environment
    from markupsafe import Markup


def fill(template: str, **values: Any) -> Markup:
    """Return the HTML of a file in ``report/templates``, with ``values`` as its variables.

    Text is escaped, and control characters in it are replaced; only `Markup` is inserted as HTML.
    Raises MissingExtraError if Jinja2 is not installed.
    """
    from markupsafe import Markup

    return Markup(_environment().get_template(template).render(values))  # noqa: S704


@cache
def _environment() -> Environment:
    try:
        from jinja2 import Environment, PackageLoader, StrictUndefined
    except ImportError as error:
        raise MissingExtraError("A report", "report") from error
    from benchnav.report.page import href, navigator_path, replay_path, scenario_path

    environment = Environment(
        loader=PackageLoader("benchnav.report"), autoescape=True, undefined=StrictUndefined,
        trim_blocks=True, lstrip_blocks=True, finalize=_printable,
    )  # fmt: skip
    environment.globals.update(
        href=href, navigator_path=navigator_path, replay_path=replay_path,
        scenario_path=scenario_path,
    )  # fmt: skip
    return environment


def _printable(value: Any) -> Any:
    """Replace control characters of plain text: names may come from plugins and files."""
    return visible(value) if type(value) is str else value
