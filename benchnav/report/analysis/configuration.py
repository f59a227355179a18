"""The parameters, the training and the mode of a navigator, from the manifest of its run."""

import json
from collections.abc import Iterator, Mapping
from typing import Any

from benchnav.leaderboard.rendering.digits import number
from benchnav.store.runs.manifest import IN_PROCESS

Fact = tuple[str, str]


def facts_of(entry: Mapping[str, Any]) -> list[Fact]:
    """Return the facts about a navigator: ``entry`` is its entry in the manifest of a run."""
    uses_map = entry.get("uses_map") is not False
    facts = [
        ("type", str(entry["config"].get("type", ""))),
        ("comes from", str(entry.get("source", "")) or "unknown"),
        ("ran", _mode(str(entry.get("mode", IN_PROCESS)))),
        ("map", "uses the map of its track" if uses_map else "uses no map: equal in all tracks"),
        ("training", training_text(entry.get("training"))),
    ]
    if rehearsal := int(entry.get("rehearsal", 0)):
        facts.append(("rehearsals", f"{rehearsal} of each world before the scored episode"))
    if fingerprint := str(entry.get("fingerprint", "")):
        facts.append(("files", f"SHA-256 of its files, such as weights: {fingerprint[:16]}…"))
    return facts


def training_text(training: Mapping[str, Any] | None) -> str:
    """Return the cost of training in words."""
    if not training:
        return "none: it does not learn before the run"
    decisions, seconds = float(training["decisions"]), float(training["seconds"])
    amount = f"{decisions / 1e6:.3g} million" if decisions >= 1e6 else f"{decisions:,.0f}"
    return f"{amount} decisions of agents in {_duration(seconds)}"


def parameters_of(config: Mapping[str, Any]) -> list[Fact]:
    """Return the parameters of a navigator; those of its parts as ``part.parameter``."""
    return list(_flat("", config))


def _flat(prefix: str, fields: Mapping[str, Any]) -> Iterator[Fact]:
    for name, value in fields.items():
        if name == "type" and not prefix:
            continue
        if isinstance(value, Mapping) and value:
            yield from _flat(f"{prefix}{name}.", value)
        else:
            text = value if isinstance(value, str) and value else json.dumps(value)
            yield f"{prefix}{name}", text


def _mode(mode: str) -> str:
    return "in the process of the runner" if mode == IN_PROCESS else "in a process of its own"


def _duration(seconds: float) -> str:
    for size, unit in ((3600.0, "h"), (60.0, "min")):
        if seconds >= 1.5 * size:
            return f"{number(seconds / size)} {unit}"
    return f"{number(seconds)} s"
