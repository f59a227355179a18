"""The plugins that form a navigator, each as the place of its definition."""

import re
import sys
from collections.abc import Iterable, Mapping
from typing import Any

from benchnav.errors import PluginError
from benchnav.plugins import CONTROLLERS, NAVIGATORS, PLANNERS, Registry
from benchnav.source.importable import MAIN, is_importable
from benchnav.source.named_files import texts_of

_REGISTRIES = (NAVIGATORS, PLANNERS, CONTROLLERS)
_BY_MODULE = re.compile(r"[A-Za-z_][\w.]*:[A-Za-z_][\w.]*")


def places_of(spec: Mapping[str, Any], declared: Iterable[str] = ()) -> tuple[str, ...]:
    """Return the places, ``module:attribute``, of the classes of a navigator and its parts, sorted.

    Args:
        spec: ``{type: name, …every parameter}``.
        declared: places of the parts that the navigator declares. Plugin names among its
            parameters count as parts too.
    """
    places = {*declared, *_places(str(spec["type"]), (NAVIGATORS,))}
    for text in texts_of({key: value for key, value in spec.items() if key != "type"}):
        places.update(_places(text, _REGISTRIES))
    return tuple(sorted(places))


def _places(name: str, registries: Iterable[Registry]) -> set[str]:
    if _BY_MODULE.fullmatch(name):
        return {name}
    found = set()
    for registry in registries:
        try:
            if name in registry:
                found.add(registry.source(name).value)
        except PluginError:  # two distributions claim the name, so it cannot be used anyway
            continue
    return found


def local_names(spec: Mapping[str, Any]) -> list[str]:
    """Return the names in ``spec`` that only this process knows, by registration."""
    return [
        text
        for text in texts_of(spec)
        if text.startswith(f"{MAIN}:") or any(registry.is_local(text) for registry in _REGISTRIES)
    ]


def live_object(place: str) -> Any:
    """Return the object at ``place`` if this process defined it; None if a module did.

    This process defines what is registered in it, and what stands in ``__main__``: a notebook or
    the running script.
    """
    module, _, attribute = place.partition(":")
    thing = _registered(place)
    if thing is None and module == MAIN:
        thing = getattr(sys.modules[MAIN], attribute, None)
    return thing if module == MAIN or not is_importable(thing) else None


def _registered(place: str) -> Any:
    found = (registry.registered(place) for registry in _REGISTRIES)
    return next((thing for thing in found if thing is not None), None)
