"""The common form of occupancy maps: blocked, free and unknown cells."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchnav.arrays import BoolArray, Extent, FloatArray
from benchnav.errors import MapError
from benchnav.geometry.rotation import rotated
from benchnav.system.plain_file import read_file

MAX_CELLS = 16_000_000


@dataclass(frozen=True, eq=False)
class Occupancy:
    """A grid in the world: row 0 at the bottom, column 0 at the left, y up."""

    blocked: BoolArray  # (H, W) True for an obstacle; never also unknown
    unknown: BoolArray  # (H, W) True if the map has no information
    cell: float  # [m] side of a cell
    origin: tuple[float, float, float]  # (x, y, yaw) [m, m, rad] of the grid's lower left corner
    doubtful: int = 0  # free cells with the grey by which map_saver marks unknown cells

    def points(self, cells: FloatArray) -> FloatArray:
        """Return world points [m] of places (…, 2), (column, row) in cells from the lower left."""
        x, y, yaw = self.origin
        scaled = np.asarray(cells, np.float64) * self.cell
        turned = rotated(scaled, yaw) if yaw != 0.0 else scaled
        return np.asarray(turned + np.array([x, y]))

    def centres(self, columns: FloatArray, rows: FloatArray) -> FloatArray:
        """Return the centres (…, 2) [m] of the cells (row 0 at the bottom)."""
        return self.points(np.stack([np.asarray(columns), np.asarray(rows)], axis=-1) + 0.5)

    @property
    def counts(self) -> tuple[int, int, int]:
        """Return the numbers of free, blocked and unknown cells."""
        blocked, unknown = int(self.blocked.sum()), int(self.unknown.sum())
        return self.blocked.size - blocked - unknown, blocked, unknown

    def free(self, unknown_is_free: bool) -> BoolArray:
        """Return where agents may be, (H, W)."""
        return ~self.blocked if unknown_is_free else ~(self.blocked | self.unknown)

    @property
    def bounds(self) -> Extent:
        """Return the box xmin, ymin, xmax, ymax [m] around the (possibly rotated) grid."""
        high, wide = self.blocked.shape
        corners = self.points(np.array([[0, 0], [wide, 0], [wide, high], [0, high]], float))
        low, top = corners.min(axis=0), corners.max(axis=0)
        return float(low[0]), float(low[1]), float(top[0]), float(top[1])


def demand_free(where: str, occupancy: Occupancy, unknown_is_free: bool, cure: str) -> None:
    """Refuse a map without free cells; ``cure`` is the option that opens its unknown cells.

    Raises:
        MapError: with the numbers of blocked and of unknown cells.
    """
    free, blocked, unknown = occupancy.counts
    if free or (unknown and unknown_is_free):
        return
    if unknown:
        raise MapError(
            f"{where}: the map must have a free cell; none is free, {blocked} are blocked"
            f" and {unknown} are unknown. {cure} opens unknown cells to agents."
        )
    raise MapError(f"{where}: the map must have a free cell; all {blocked} are blocked.")


def check_size(where: str, width: int, height: int) -> None:
    """Refuse a map without cells, or with more than ``MAX_CELLS``.

    Raises:
        MapError: with the declared size and the limit.
    """
    if width < 1 or height < 1:
        raise MapError(f"{where}: width and height must be ≥ 1; got {width} × {height}.")
    if width * height > MAX_CELLS:
        raise MapError(
            f"{where}: a map has at most {MAX_CELLS} cells; "
            f"got {width} × {height} = {width * height}. Cut it or scale it down."
        )


def read_bytes(path: Path, limit: int, subject: str) -> bytes:
    """Return the content of a file of at most ``limit`` bytes; ``subject`` is for messages.

    Raises:
        MapError: it is missing, unreadable or larger.
    """
    try:
        raw = read_file(path, limit)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise MapError(f"{path}:1: {subject} cannot be read: {reason}.") from None
    if len(raw) > limit:
        raise MapError(f"{path}:1: {subject} must have at most {limit} bytes; it is larger.")
    return raw
