"""The shortest path of a disc, exact except for rounding, by tangents and arcs."""

from weakref import WeakKeyDictionary

from pydantic import Field

from benchnav.arrays import FloatArray
from benchnav.geometry import FreeSpace
from benchnav.navigation import Map, PluginConfig

from ..common.clearance_planner import ClearanceConfig
from ..common.disc_planner import DiscPlanner, Query


class Visibility(DiscPlanner):
    """The generalised visibility graph (Latombe 1991, chapter 4): `benchnav.geometry.geodesic`.

    It is the path whose length is the metric `geodesic_length`, for the disc enlarged
    by the clearance. Around corners it is a polyline outside the arc, longer than the arc
    by a share of bend² / 12.
    """

    class Config(ClearanceConfig):
        """Parameters."""

        bend: float = Field(
            0.1, ge=1e-4, le=1.0, description="[rad] largest turn at a waypoint on an arc"
        )

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self._spaces: WeakKeyDictionary[Map, dict[float, FreeSpace]] = WeakKeyDictionary()

    def search(self, query: Query) -> tuple[FloatArray, int]:
        known = self._spaces.setdefault(query.map, {})
        if query.inflation not in known:
            known[query.inflation] = FreeSpace(query.map.capsules, query.inflation)
        space, bend = known[query.inflation], self.config.bend
        path = space.path(query.start, query.goal, 0.0, bend)
        if not len(path) and query.slack > 0.0:
            path = space.path(query.start, query.goal, query.slack, bend)
        return path, 0
