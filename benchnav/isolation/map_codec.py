"""Maps ↔ fields of a frame."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from benchnav.arena.mesh import Mesh
from benchnav.arena.solid import Kind, Solid
from benchnav.isolation.ragged_codec import counts, slices, stack
from benchnav.navigation.map import Map

_NO_BOUNDS = (0.0, 0.0, 0.0, 0.0)


def encode_maps(maps: Sequence[Map | None]) -> dict[str, Any]:
    """Return the frame fields of ``maps`` (N,); None stands for a world without a map."""
    granted = [map for map in maps if map is not None]
    solids = [solid for map in granted for solid in map.solids]
    loops = [loop for solid in solids for loop in solid.loops]
    fields: dict[str, Any] = {
        "map.granted": np.array([map is not None for map in maps], np.bool_),
        "map.bounds": np.array([_NO_BOUNDS if map is None else map.bounds for map in maps]),
        "map.revision": counts(0 if map is None else map.revision for map in maps),
        "map.solids": counts(0 if map is None else len(map.solids) for map in maps),
        "solid.kind": np.array([int(solid.kind) for solid in solids], np.int8),
        "solid.center": np.array([solid.center for solid in solids], float).reshape(-1, 2),
        "solid.radius": np.array([solid.radius for solid in solids], float),
        "solid.loops": counts(len(solid.loops) for solid in solids),
        "loop.vertices": counts(map(len, loops)),
        "vertex": stack(loops, 2),
    }
    return fields | _encode_meshes(maps, [mesh for map in granted for mesh in map.meshes])


def decode_maps(fields: dict[str, Any]) -> list[Map | None]:
    """Return the maps that `encode_maps` turned into ``fields``."""
    vertex = fields["vertex"]
    vertex.setflags(write=False)
    loops = [vertex[part] for part in slices(fields["loop.vertices"])]
    owned = [tuple(loops[part]) for part in slices(fields["solid.loops"])]
    kinds, centers = fields["solid.kind"].tolist(), fields["solid.center"].tolist()
    radii = fields["solid.radius"].tolist()
    solids = [
        Solid(Kind(kind), loop, tuple(center), radius)
        for kind, loop, center, radius in zip(kinds, owned, centers, radii, strict=True)
    ]
    for solid in solids:
        solid.capsules.setflags(write=False)
    bounds, revisions = fields["map.bounds"].tolist(), fields["map.revision"].tolist()
    meshes = _decode_meshes(fields)
    return [
        Map(tuple(bounds[n]), tuple(solids[part]), revisions[n], meshes[n]) if is_granted else None
        for n, (is_granted, part) in enumerate(
            zip(fields["map.granted"], slices(fields["map.solids"]), strict=True)
        )
    ]


def _encode_meshes(maps: Sequence[Map | None], meshes: list[Mesh]) -> dict[str, Any]:
    if not meshes:
        return {}
    return {
        "map.meshes": counts(0 if map is None else len(map.meshes) for map in maps),
        "mesh.band": np.array([mesh.band for mesh in meshes], float),
        "mesh.vertices": counts(len(mesh.vertices) for mesh in meshes),
        "mesh.faces": counts(len(mesh.faces) for mesh in meshes),
        "mesh.vertex": stack([mesh.vertices for mesh in meshes], 3),
        "mesh.face": stack([mesh.faces for mesh in meshes], 3, np.int64),
    }


def _decode_meshes(fields: dict[str, Any]) -> list[tuple[Mesh, ...]]:
    if "map.meshes" not in fields:
        return [()] * len(fields["map.granted"])
    band = fields["mesh.band"].tolist()
    pieces = zip(slices(fields["mesh.vertices"]), slices(fields["mesh.faces"]), strict=True)
    meshes = [
        Mesh(fields["mesh.vertex"][vertices], fields["mesh.face"][faces], tuple(band[k]))
        for k, (vertices, faces) in enumerate(pieces)
    ]
    return [tuple(meshes[part]) for part in slices(fields["map.meshes"])]
