"""Interactive figures in pages: a figure is drawn by plotly.js when it is scrolled into view."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from benchnav.text.visible import visible

if TYPE_CHECKING:
    from markupsafe import Markup

HEIGHT = 380  # [px]


def figure_html(
    figure: Mapping[str, Any], *, label: str, height: int = HEIGHT, caption: str = ""
) -> Markup:
    """Return a figure as HTML, for a page with ``has_figures``.

    Args:
        figure: a plotly figure in its plain form, ``{"data": [...], "layout": {...}}``. The
            colours of text, grid and paper are those of the page: it should not set them.
        label: a sentence that says what the figure shows, for screen readers.
        height: [px].
        caption: text below the figure.
    """
    from markupsafe import Markup, escape
    from plotly.io.json import to_json_plotly

    # It writes "<" as \u003c, so that no text ends the script element.
    text = to_json_plotly(figure, engine="json")
    below = f"<figcaption>{escape(visible(caption))}</figcaption>" if caption else ""
    return Markup(  # noqa: S704 - each part is escaped
        f'<figure class="plot"><div class="plot-area" role="img" style="height:{height:d}px"'
        f' aria-label="{escape(visible(label))}"></div>'
        f'<script type="application/json">{text}</script>{below}</figure>'
    )


def plain(text: str) -> str:
    """Return text that plotly shows literally: it reads some HTML in names and hover texts."""
    safe = visible(text)
    return safe.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
