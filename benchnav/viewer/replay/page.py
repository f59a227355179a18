"""A replay as an HTML page that opens from disk, alone or beside others that share its assets."""

import json
from collections.abc import Sequence
from html import escape
from importlib.resources import files
from typing import Any

ASSETS = ("replay.css", "replay.js")


def replay_page(scenes: Sequence[dict[str, Any]], assets: str = "", back: str = "") -> str:
    """Return the page that plays episodes side by side and in step.

    Args:
        scenes: the episodes, as `benchnav.viewer.replay.scene.scene` returns them.
        assets: the relative link to a folder with the files `ASSETS`; "": they are in the page.
        back: the relative link to the page of a report that led here; "": no link is shown.
    """
    # Stored numbers are finite: the simulator and the reader of runs refuse others.
    content = json.dumps(list(scenes), separators=(",", ":"), allow_nan=False)
    style, script = _linked(assets) if assets else _included()
    return _PAGE.format(
        title=escape(_title(scenes)), style=style, script=script,
        content=content.replace("<", "\\u003c"), back=escape(back),
    )  # fmt: skip


def asset(name: str) -> str:
    """Return the text of one of `ASSETS`."""
    return (files("benchnav.viewer.replay") / name).read_text(encoding="utf-8")


def _included() -> tuple[str, str]:
    style, script = map(asset, ASSETS)
    return f"<style>\n{style}</style>", f"<script>\n{script}</script>"


def _linked(folder: str) -> tuple[str, str]:
    style, script = (escape(f"{folder}/{name}") for name in ASSETS)
    return f'<link rel="stylesheet" href="{style}">', f'<script src="{script}"></script>'


def _title(scenes: Sequence[dict[str, Any]]) -> str:
    """Return the navigators and the world, or each of them if the worlds differ."""
    worlds = {f"{scene['scenario']}, seed {scene['seed']}": scene["navigator"] for scene in scenes}
    if len(worlds) > 1:
        return "; ".join(f"{navigator} in {world}" for world, navigator in worlds.items())
    navigators = ", ".join(dict.fromkeys(scene["navigator"] for scene in scenes))
    return f"{navigators} in {next(iter(worlds))}"


_PAGE = """<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
{style}
<div id="replay" data-back="{back}"></div>
<script type="application/json" id="scenes">{content}</script>
{script}
</html>
"""
