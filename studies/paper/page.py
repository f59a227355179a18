"""The page, from top to bottom."""

from collections.abc import Iterator
from pathlib import Path

from . import claims, curves, groups, moved, movers, table_2
from .evidence import Evidence
from .pictures import Pictures


def page(run: Path, pictures: Pictures) -> str:
    """All of it. Raises UsageError where the run is not a whole one of the suite ``paper``."""
    return "\n".join(_lines(Evidence.of(run), pictures))


def _lines(evidence: Evidence, pictures: Pictures) -> Iterator[str]:
    behaviours = movers.behaviours(evidence)
    yield from _head(evidence)
    yield from claims.section(claims.Material(evidence, behaviours))
    yield from table_2.section(evidence)
    yield from moved.section(evidence)
    yield from movers.section(evidence, behaviours, pictures)
    yield from curves.section()
    pictures.curves()
    yield from groups.section(evidence, pictures)


def _head(evidence: Evidence) -> Iterator[str]:
    manifest = evidence.manifest
    first, stop = manifest.suite["seeds"]
    yield "# The paper, measured"
    yield ""
    yield (
        "*Crowd Navigation in an Unknown and Dynamic Environment Based on Deep Reinforcement"
        " Learning* shows pictures and a table without numbers. This page measures its"
        " claims. It is generated; do not edit it:"
    )
    yield ""
    yield "```text"
    yield "benchnav run paper --out runs/paper"
    yield "python -m studies.paper runs/paper"
    yield "```"
    yield ""
    yield (
        f"Run of {manifest.name}, worlds {first} to {stop - 1} of split"
        f" {manifest.suite['split']}, begun"
        f" {manifest.created[:10]}, with benchnav {manifest.versions.get('benchnav')} and the"
        " shipped"
        " weights. Success is arrival with no collision before it, per agent; every interval is"
        " 95 %,"
        " clustered by world, and differences are paired by world. `recurrent-ppo` is the method"
        " as printed: predicted collisions enter its reward, but correct no command."
    )
    yield ""
