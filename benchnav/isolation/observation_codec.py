"""Observations ↔ fields of a frame."""

from collections.abc import Sequence
from dataclasses import fields as fields_of
from typing import Any

import numpy as np

from benchnav.isolation.map_codec import decode_maps, encode_maps
from benchnav.navigation.map import Map
from benchnav.navigation.observation import Observation
from benchnav.sensors.readings import FORM, Edges, Neighbours, Rays

_SENSORS: dict[str, Any] = {"rays": Rays, "neighbours": Neighbours, "edges": Edges}
_READINGS = {  # of a sensor: (attribute, field of the frame) of each array
    sensor: [(f.name, f"{sensor}.{f.name}") for f in fields_of(kind)]
    for sensor, kind in _SENSORS.items()
}
_OWN = ("rows", "time", "active", "position", "heading", "velocity", "goal")
_STEERING = "steering"
_CHANGED = "map.rows"


def encode_observation(observation: Observation, changed: Sequence[int]) -> dict[str, Any]:
    """Return the frame fields of an observation, and the maps of batch places ``changed`` only."""
    fields: dict[str, Any] = {name: getattr(observation, name) for name in _OWN}
    if observation.steering.any():  # left out if no wheels are turned
        fields[_STEERING] = observation.steering
    for sensor, names in _READINGS.items():
        readings = getattr(observation, sensor)
        if readings is not None:
            for attribute, name in names:
                value = getattr(readings, attribute)
                if attribute not in FORM or value.any():  # left out if all bodies are discs
                    fields[name] = value
    if changed:
        fields[_CHANGED] = observation.rows[np.array(changed)]
        fields |= encode_maps([observation.maps[b] for b in changed])
    return fields


def decode_changed_maps(fields: dict[str, Any]) -> dict[int, Map | None]:
    """Return the new maps, by row."""
    if _CHANGED not in fields:
        return {}
    return dict(zip(fields[_CHANGED].tolist(), decode_maps(fields), strict=True))


def decode_observation(fields: dict[str, Any], maps: dict[int, Map | None]) -> Observation:
    """Return the observation that `encode_observation` encoded; ``maps`` holds the maps by row."""
    readings_by_sensor = {
        sensor: _SENSORS[sensor](
            **{attribute: fields[name] for attribute, name in names if name in fields}
        )
        for sensor, names in _READINGS.items()
        if names[0][1] in fields
    }
    own = {name: fields[name] for name in (*_OWN, _STEERING) if name in fields}
    held = tuple(maps[row] for row in fields["rows"].tolist())
    return Observation(**own, maps=held, **readings_by_sensor)
