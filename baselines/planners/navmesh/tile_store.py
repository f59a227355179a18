"""The triangles of tiles that were used last."""

from collections import OrderedDict
from collections.abc import Sequence

from benchnav.arrays import FloatArray

from .tile import Tile, triangulated

MOST_BYTES = 64_000_000  # of triangles in memory; a larger map has its own in addition


class TileStore:
    """Triangulates only unknown tiles. The answer is the same whatever tiles are known."""

    def __init__(self, most_bytes: int = MOST_BYTES) -> None:
        self._most_bytes = most_bytes
        self._held: OrderedDict[tuple[float, int, Tile], FloatArray] = OrderedDict()
        self._bytes = 0

    def triangles(self, tiles: Sequence[Tile], inflation: float, segments: int) -> list[FloatArray]:
        """Return the free triangles (T, 3, 2) [m] of each tile, like `triangulated`."""
        keys = [(inflation, segments, tile) for tile in tiles]
        new = [key for key in keys if key not in self._held]
        made = triangulated([tile for *_, tile in new], inflation, segments) if new else []
        for key, corner in zip(new, made, strict=True):
            self._held[key] = corner.copy()  # a part of a larger array would keep all of it
            self._bytes += _size(key, corner)
        for key in keys:
            self._held.move_to_end(key)
        found = [self._held[key] for key in keys]
        while self._bytes > self._most_bytes:
            self._bytes -= _size(*self._held.popitem(last=False))
        return found


def _size(key: tuple[float, int, Tile], corner: FloatArray) -> int:
    return corner.nbytes + len(key[2][3])
