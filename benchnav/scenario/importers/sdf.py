"""Obstacles of SDF worlds and models, the format of Gazebo: http://sdformat.org/spec.

Collision shapes within the agents' band of heights are obstacles. The block <state> is left out:
it repeats the poses of the models.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from benchnav.arrays import FloatArray, IntArray
from benchnav.config.document import shown
from benchnav.errors import WorldFileError, did_you_mean
from benchnav.scenario.files.mesh_file import Up, merged, place, read_triangles
from benchnav.scenario.files.mesh_section import section
from benchnav.scenario.importers.plan_view import MAX_PIECES, Piece, box, disc, polygons
from benchnav.scenario.importers.xml_tree import Element, read_xml

MAX_INCLUDES = 8  # nested
LARGEST = 1e5  # [m]
_FLAT = 1e-6  # [rad] smaller roll and pitch are none
_SIDES = 32  # of a prism that stands for a tilted cylinder
_SCENERY = {"sun", "ground_plane"}  # models of Gazebo without obstacles
_SHAPES = ("box", "cylinder", "sphere", "capsule", "ellipsoid", "mesh", "polyline", "plane")


@dataclass(frozen=True, kw_only=True)
class SdfOptions:
    """How meshes are read, and where models are searched."""

    band: tuple[float, float] = (0.05, 2.0)  # [m] heights above the floor
    unit: float | None = None  # [m] of meshes; None: as each file declares
    up: Up | None = None  # of meshes; None: z, because Gazebo ignores what the file declares
    scale: float = 1.0  # of meshes, in addition to that of the world
    models: Sequence[Path] = ()
    skip_missing: bool = False  # leave out models and meshes that are not found


@dataclass
class SdfWorld:
    """The obstacles, and what was left out."""

    pieces: list[Piece] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class _Pose:
    """A rotation (3, 3) and a translation (3,) [m]."""

    turn: FloatArray
    move: FloatArray

    def then(self, inner: "_Pose") -> "_Pose":
        """Return the pose of a frame that is posed in this one."""
        return _Pose(self.turn @ inner.turn, self.turn @ inner.move + self.move)

    @property
    def yaw(self) -> float | None:
        """The heading [rad]; None if the frame is tilted."""
        if abs(self.turn[2, 2] - 1.0) > _FLAT:
            return None
        return math.atan2(self.turn[1, 0], self.turn[0, 0])


_ORIGIN = _Pose(np.eye(3), np.zeros(3))


def read_sdf(path: Path, options: SdfOptions) -> SdfWorld:
    """Return the obstacles of a world or model file.

    Raises:
        WorldFileError: with file and line: it is not SDF, a number or shape is wrong, or a model
            or mesh is not found.
        MeshError: a mesh is wrong.
        MissingExtraError: the file names meshes, and trimesh is not installed.
    """
    reader = _Reader(options)
    reader.read(path, _ORIGIN, 0)
    if not reader.world.pieces:
        low, high = options.band
        raise WorldFileError(
            f"{path}:1: the world must have an obstacle between {low:g} m and {high:g} m; it has"
            " none. Check the band."
        )
    return reader.world


class _Reader:
    def __init__(self, options: SdfOptions) -> None:
        self.options = options
        self.world = SdfWorld()
        self.meshes: dict[Path, tuple[FloatArray, IntArray, float]] = {}

    def read(self, path: Path, pose: _Pose, depth: int) -> None:
        root = read_xml(path, "sdf")
        for parent in (root, *root.all("world")):
            self._models(path, parent, pose, depth)

    def _models(self, path: Path, parent: Element, pose: _Pose, depth: int) -> None:
        for model in parent.all("model"):
            self._model(path, model, pose.then(_pose(path, model)), depth)
        for include in parent.all("include"):
            self._include(path, include, pose, depth)
        for tag in ("actor", "population", "road"):
            left = sum(1 for _ in parent.all(tag))
            if left:
                self.world.remarks.append(f"Left out: {left} × <{tag}>.")

    def _model(self, path: Path, model: Element, pose: _Pose, depth: int) -> None:
        self._models(path, model, pose, depth)
        for link in model.all("link"):
            at = pose.then(_pose(path, link))
            for collision in link.all("collision"):
                geometry = collision.first("geometry")
                if geometry is not None:
                    self._shape(path, geometry, at.then(_pose(path, collision)))

    def _include(self, path: Path, include: Element, pose: _Pose, depth: int) -> None:
        uri = include.first("uri")
        if uri is None or not uri.text:
            raise WorldFileError(f"{path}:{include.line}: <include> must have a <uri>.")
        if uri.text.rstrip("/").rpartition("/")[2] in _SCENERY:
            return
        if depth >= MAX_INCLUDES:
            raise WorldFileError(
                f"{path}:{include.line}: models may include others at most {MAX_INCLUDES} deep."
            )
        found = self._find(path, uri)
        if found is None:
            return
        if found.is_dir():
            found = _model_file(found)
        self.read(found, pose.then(_pose(path, include)), depth + 1)

    def _find(self, path: Path, uri: Element) -> Path | None:
        """Return the file or folder that a URI names; None if it may be missing."""
        scheme, found, rest = uri.text.partition("://")
        name = rest if found else uri.text
        if (found and scheme not in ("model", "file", "package")) or ".." in Path(name).parts:
            name = ""
        folder = path.resolve().parent
        places = [folder, folder.parent, *self.options.models]
        if scheme == "file" and name.startswith("/"):
            places = [Path("/")]
        for place_ in places if name else ():
            each = place_ / name.lstrip("/")
            if each.exists():
                return each
        if self.options.skip_missing:
            self.world.remarks.append(f"Left out: {shown(uri.text)}, which is not found.")
            return None
        raise WorldFileError(
            f"{path}:{uri.line}: the file {shown(uri.text)!r} must exist; it is not found."
            " The option 'models' names the folder of models, 'skip-missing' leaves it out."
        )

    def _shape(self, path: Path, geometry: Element, pose: _Pose) -> None:
        if not geometry.children:
            raise WorldFileError(f"{path}:{geometry.line}: <geometry> must have a shape.")
        shape = geometry.children[0]
        if shape.tag not in _SHAPES:
            if shape.tag in ("heightmap", "image", "empty"):
                if shape.tag != "empty":
                    self.world.remarks.append(f"Left out: <{shape.tag}> in line {shape.line}.")
                return
            raise WorldFileError(
                f"{path}:{shape.line}: a shape must be one of {', '.join(_SHAPES)}; got"
                f" <{shown(shape.tag)}>.{did_you_mean(shape.tag, _SHAPES)}"
            )
        if shape.tag != "plane":
            self.world.pieces += self._pieces(path, shape, pose)
        if len(self.world.pieces) > 100 * MAX_PIECES:
            raise WorldFileError(f"{path}:{shape.line}: there are too many obstacles.")

    def _pieces(self, path: Path, shape: Element, pose: _Pose) -> Iterator[Piece]:
        band, (x, y, z) = self.options.band, pose.move
        if max(abs(x), abs(y), abs(z)) > LARGEST:
            raise WorldFileError(
                f"{path}:{shape.line}: a position must be within {LARGEST:g} m of the origin; got"
                f" {x:.4g}, {y:.4g}, {z:.4g}."
            )
        if shape.tag == "mesh":
            yield from polygons(section(*self._mesh(path, shape, pose), band))
            return
        if shape.tag == "sphere":
            radius = _number(path, shape, "radius")
            off = max(band[0] - z, z - band[1], 0.0)
            if off < radius:
                yield disc(x, y, math.sqrt(radius * radius - off * off))
            return
        vertices, faces, upright = _solid(path, shape)
        if pose.yaw is not None and upright is not None:
            half = 0.5 * float(np.ptp(vertices[:, 2]))
            if z - half < band[1] and z + half > band[0]:
                yield upright(x, y, pose.yaw)
            return
        yield from polygons(section(vertices @ pose.turn.T + pose.move, faces, band))

    def _mesh(self, path: Path, shape: Element, pose: _Pose) -> tuple[FloatArray, IntArray]:
        """Return the triangles of a mesh in the world."""
        uri = shape.first("uri")
        if uri is None or not uri.text:
            raise WorldFileError(f"{path}:{shape.line}: <mesh> must have a <uri>.")
        file = self._find(path, uri)
        if file is None:
            return np.zeros((0, 3)), np.zeros((0, 3), np.int64)
        if file not in self.meshes:
            vertices, faces, unit, _ = read_triangles(file)
            self.meshes[file] = vertices, faces, unit
        vertices, faces, unit = self.meshes[file]
        scale = _numbers(path, shape, "scale", 3, (1.0, 1.0, 1.0)) * self.options.scale
        placed = place(
            vertices,
            self.options.unit or unit,
            self.options.up or "z",
            scale.tolist(),
            0.0,
            (0.0, 0.0),
        )
        return merged(placed @ pose.turn.T + pose.move, faces)


def _model_file(folder: Path) -> Path:
    """Return the SDF file of a model's folder: as in model.config, or model.sdf."""
    config = folder / "model.config"
    if config.exists():
        named = [e for e in read_xml(config, "model").all("sdf") if e.text]
        if named and "/" not in named[-1].text and "\\" not in named[-1].text:
            return folder / named[-1].text
    return folder / "model.sdf"


def _pose(path: Path, element: Element) -> _Pose:
    pose = element.first("pose")
    if pose is None:
        return _ORIGIN
    frame = pose.attributes.get("relative_to") or pose.attributes.get("frame") or ""
    if frame not in ("", "__model__", "world"):
        raise WorldFileError(
            f"{path}:{pose.line}: a pose must be relative to its parent; got the frame"
            f" {shown(frame)!r}. Export the world with resolved poses: gz sdf -p."
        )
    if pose.attributes.get("rotation_format", "euler_rpy") != "euler_rpy":
        raise WorldFileError(f"{path}:{pose.line}: a pose must be x y z roll pitch yaw.")
    if not pose.text:
        return _ORIGIN
    x, y, z, *angles = _parsed(path, pose, 6)
    if pose.attributes.get("degrees") in ("true", "1"):
        angles = [math.radians(angle) for angle in angles]
    (sr, sp, sy), (cr, cp, cy) = np.sin(angles), np.cos(angles)
    turn = np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )
    return _Pose(turn, np.array([x, y, z]))


def _solid(
    path: Path, shape: Element
) -> tuple[FloatArray, IntArray, Callable[[float, float, float], Piece] | None]:
    """Return a convex body: vertices, faces, and its plan view if it stands upright."""
    if shape.tag == "box":
        w, d, h = _numbers(path, shape, "size", 3)
        plan = 0.5 * np.array([[-w, -d], [w, -d], [w, d], [-w, d]])
        return *_prism(plan, -0.5 * h, 0.5 * h), lambda x, y, a: box(x, y, w, d, a)
    if shape.tag == "polyline":
        points = np.array([_parsed(path, p, 2) for p in shape.all("point")]).reshape(-1, 2)
        if len(points) < 3:
            raise WorldFileError(f"{path}:{shape.line}: a <polyline> must have three points.")
        vertices, faces = _prism(points, 0.0, _number(path, shape, "height"))
        return vertices, faces[: 2 * len(points)], None  # its plan may not be convex: no caps
    angle = (np.arange(_SIDES) + 0.5) * (2.0 * math.pi / _SIDES)
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1) / math.cos(math.pi / _SIDES)
    if shape.tag == "ellipsoid":
        a, b, c = _numbers(path, shape, "radii", 3)
        return *_prism(circle * [a, b], -c, c), None
    radius, half = _number(path, shape, "radius"), 0.5 * _number(path, shape, "length")
    half += radius if shape.tag == "capsule" else 0.0
    return *_prism(circle * radius, -half, half), lambda x, y, _: disc(x, y, radius)


def _prism(plan: FloatArray, low: float, high: float) -> tuple[FloatArray, IntArray]:
    """Return a prism over the corners (N, 2) of a plan, from height ``low`` to ``high``."""
    n = len(plan)
    vertices = np.vstack([np.column_stack([plan, np.full(n, z)]) for z in (low, high)])
    k, after = np.arange(n), (np.arange(n) + 1) % n
    sides = [np.stack([k, after, k + n], 1), np.stack([after, after + n, k + n], 1)]
    fan = np.arange(1, n - 1)
    caps = [np.stack([0 * fan, fan + 1, fan], 1), np.stack([0 * fan, fan, fan + 1], 1) + n]
    return vertices, np.vstack([*sides, *caps])


def _number(path: Path, shape: Element, name: str) -> float:
    return float(_numbers(path, shape, name, 1)[0])


def _numbers(
    path: Path, shape: Element, name: str, count: int, default: Sequence[float] | None = None
) -> FloatArray:
    """Return positive numbers of a child element."""
    child = shape.first(name)
    if child is None:
        if default is not None:
            return np.array(default)
        raise WorldFileError(f"{path}:{shape.line}: <{shape.tag}> must have a <{name}>.")
    found = np.array(_parsed(path, child, count))
    if not (found > 0.0).all():
        raise WorldFileError(
            f"{path}:{child.line}: <{name}> must be > 0; got {shown(child.text)!r}."
        )
    return found


def _parsed(path: Path, element: Element, count: int) -> list[float]:
    words = element.text.split()
    try:
        found = [float(word) for word in words[: count + 1]]
    except ValueError:
        found = []
    if len(found) != count or not all(abs(number) <= LARGEST for number in found):
        what = "a number" if count == 1 else f"{count} numbers"
        raise WorldFileError(
            f"{path}:{element.line}: <{element.tag}> must be {what} up to {LARGEST:g}; got"
            f" {shown(element.text)!r}."
        )
    return found
