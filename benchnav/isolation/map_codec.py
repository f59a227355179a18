"""Maps ↔ the fields of a frame."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from benchnav.arena.mesh import Mesh
from benchnav.arena.solid import Kind, Solid
from benchnav.isolation.ragged_codec import counts, parts, stacked
from benchnav.navigation.map import Map

_NOWHERE = (0.0, 0.0, 0.0, 0.0)


def charted(maps: Sequence[Map | None]) -> dict[str, Any]:
    """The fields of ``maps`` (N,), of which None is a world without one."""
    held = [map for map in maps if map is not None]
    solids = [solid for map in held for solid in map.solids]
    loops = [loop for solid in solids for loop in solid.loops]
    fields: dict[str, Any] = {
        "map.granted": np.array([map is not None for map in maps], np.bool_),
        "map.bounds": np.array([_NOWHERE if map is None else map.bounds for map in maps]),
        "map.revision": counts(0 if map is None else map.revision for map in maps),
        "map.solids": counts(0 if map is None else len(map.solids) for map in maps),
        "solid.kind": np.array([int(solid.kind) for solid in solids], np.int8),
        "solid.center": np.array([solid.center for solid in solids], float).reshape(-1, 2),
        "solid.radius": np.array([solid.radius for solid in solids], float),
        "solid.loops": counts(len(solid.loops) for solid in solids),
        "loop.vertices": counts(map(len, loops)),
        "vertex": stacked(loops, 2),
    }
    return fields | _meshed(maps, [mesh for map in held for mesh in map.meshes])


def maps_of(fields: dict[str, Any]) -> list[Map | None]:
    """The maps that `charted` made ``fields`` of."""
    vertex = fields["vertex"]
    vertex.setflags(write=False)
    loops = [vertex[part] for part in parts(fields["loop.vertices"])]
    owned = [tuple(loops[part]) for part in parts(fields["solid.loops"])]
    kinds, centers = fields["solid.kind"].tolist(), fields["solid.center"].tolist()
    radii = fields["solid.radius"].tolist()
    solids = [
        Solid(Kind(kind), loop, tuple(center), radius)
        for kind, loop, center, radius in zip(kinds, owned, centers, radii, strict=True)
    ]
    for solid in solids:
        solid.capsules.setflags(write=False)
    bounds, revisions = fields["map.bounds"].tolist(), fields["map.revision"].tolist()
    meshes = _meshes_of(fields)
    return [
        Map(tuple(bounds[n]), tuple(solids[part]), revisions[n], meshes[n]) if granted else None
        for n, (granted, part) in enumerate(
            zip(fields["map.granted"], parts(fields["map.solids"]), strict=True)
        )
    ]


def _meshed(maps: Sequence[Map | None], meshes: list[Mesh]) -> dict[str, Any]:
    if not meshes:
        return {}
    return {
        "map.meshes": counts(0 if map is None else len(map.meshes) for map in maps),
        "mesh.band": np.array([mesh.band for mesh in meshes], float),
        "mesh.vertices": counts(len(mesh.vertices) for mesh in meshes),
        "mesh.faces": counts(len(mesh.faces) for mesh in meshes),
        "mesh.vertex": stacked([mesh.vertices for mesh in meshes], 3),
        "mesh.face": stacked([mesh.faces for mesh in meshes], 3, np.int64),
    }


def _meshes_of(fields: dict[str, Any]) -> list[tuple[Mesh, ...]]:
    if "map.meshes" not in fields:
        return [()] * len(fields["map.granted"])
    band = fields["mesh.band"].tolist()
    where = zip(parts(fields["mesh.vertices"]), parts(fields["mesh.faces"]), strict=True)
    meshes = [
        Mesh(fields["mesh.vertex"][vertices], fields["mesh.face"][faces], tuple(band[k]))
        for k, (vertices, faces) in enumerate(where)
    ]
    return [tuple(meshes[part]) for part in parts(fields["map.meshes"])]
