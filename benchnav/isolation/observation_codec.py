"""Observations ↔ the fields of a frame."""

from collections.abc import Sequence
from dataclasses import fields as fields_of
from typing import Any

import numpy as np

from benchnav.isolation.map_codec import charted, maps_of
from benchnav.navigation.map import Map
from benchnav.navigation.observation import Observation
from benchnav.sensors.readings import Edges, Neighbours, Rays

_SENSORS: dict[str, Any] = {"rays": Rays, "neighbours": Neighbours, "edges": Edges}
_OWN = ("rows", "time", "active", "position", "heading", "velocity", "goal")
_CHANGED = "map.rows"


def seen(observation: Observation, changed: Sequence[int]) -> dict[str, Any]:
    """The fields of an observation, and the maps of the places ``changed`` in it alone."""
    fields: dict[str, Any] = {name: getattr(observation, name) for name in _OWN}
    for sensor in _SENSORS:
        readings = getattr(observation, sensor)
        if readings is not None:
            for f in fields_of(readings):
                fields[f"{sensor}.{f.name}"] = getattr(readings, f.name)
    if changed:
        fields[_CHANGED] = observation.rows[np.array(changed)]
        fields |= charted([observation.maps[b] for b in changed])
    return fields


def maps_changed(fields: dict[str, Any]) -> dict[int, Map | None]:
    """The new maps, by row."""
    if _CHANGED not in fields:
        return {}
    return dict(zip(fields[_CHANGED].tolist(), maps_of(fields), strict=True))


def observation_of(fields: dict[str, Any], maps: dict[int, Map | None]) -> Observation:
    """The observation that `seen` made ``fields`` of, with what ``maps`` holds by row."""
    sensed = {
        sensor: kind(**{f.name: fields[f"{sensor}.{f.name}"] for f in fields_of(kind)})
        for sensor, kind in _SENSORS.items()
        if f"{sensor}.{fields_of(kind)[0].name}" in fields
    }
    own = [fields[name] for name in _OWN]
    made: Any = Observation
    observation: Observation = made(
        *own, tuple(maps[row] for row in fields["rows"].tolist()), **sensed
    )
    return observation
