"""A replay as one HTML page without links to other files: it opens from disk."""

import json
from collections.abc import Sequence
from html import escape
from importlib.resources import files
from typing import Any


def replay_page(scenes: Sequence[dict[str, Any]]) -> str:
    """Return the page that plays episodes side by side and in step."""
    # Stored numbers are finite: the simulator and the reader of runs refuse others.
    content = json.dumps(list(scenes), separators=(",", ":"), allow_nan=False)
    return _PAGE.format(
        title=escape(_title(scenes)), style=_asset("replay.css"),
        script=_asset("replay.js"), content=content.replace("<", "\\u003c"),
    )  # fmt: skip


def _asset(name: str) -> str:
    """Return the text of a file beside this module."""
    return (files("benchnav.viewer.replay") / name).read_text(encoding="utf-8")


def _title(scenes: Sequence[dict[str, Any]]) -> str:
    first = scenes[0]
    navigators = ", ".join(dict.fromkeys(scene["navigator"] for scene in scenes))
    return f"{navigators} in {first['scenario']}, seed {first['seed']}"


_PAGE = """<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>
{style}</style>
<div id="replay"></div>
<script type="application/json" id="scenes">{content}</script>
<script>
{script}</script>
</html>
"""
