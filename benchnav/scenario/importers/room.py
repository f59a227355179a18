"""The largest connected part of a map in which a disc can move."""

from dataclasses import dataclass

import numpy as np

from benchnav.arrays import BoolArray, Extent
from benchnav.scenario.importers.grid import Occupancy

SHARE = 6.0  # [radii] side of the square of free space that each agent is given


@dataclass(frozen=True)
class Room:
    """Connected free cells that a disc's centre can be in."""

    box: Extent  # xmin, ymin, xmax, ymax [m] around them
    area: float  # [m²]
    radius: float  # [m] of the disc

    @property
    def capacity(self) -> int:
        """The number of agents that fit with space to move."""
        return int(self.area / (SHARE * self.radius) ** 2)

    @property
    def sides(self) -> tuple[float, float]:
        """Width and height [m] of the box."""
        x0, y0, x1, y1 = self.box
        return x1 - x0, y1 - y0


def largest_room(occupancy: Occupancy, free: BoolArray, radius: float) -> Room | None:
    """Return the largest connected set of cells that a disc of ``radius`` [m] can be in.

    ``free`` is (H, W). The set is measured between cells, so it is approximate; `build` tests each
    place exactly. None if there is no such cell.
    """
    from scipy import ndimage

    to_blocked = ndimage.distance_transform_edt(np.pad(free, 1))[1:-1, 1:-1]
    label, count = ndimage.label((to_blocked - 0.5) * occupancy.cell >= radius)
    if count == 0:
        return None
    sizes = np.bincount(label.ravel())[1:]
    row, column = np.nonzero(label == 1 + int(np.argmax(sizes)))
    corners = np.stack([column, row], axis=1)[:, None] + np.array([[0, 0], [1, 0], [0, 1], [1, 1]])
    places = occupancy.points(corners.reshape(-1, 2).astype(np.float64))
    x0, y0, x1, y1 = occupancy.bounds
    low = np.maximum(np.round(places.min(axis=0), 3), (x0, y0))
    top = np.minimum(np.round(places.max(axis=0), 3), (x1, y1))
    box = float(low[0]), float(low[1]), float(top[0]), float(top[1])
    return Room(box, float(sizes.max()) * occupancy.cell**2, radius)
