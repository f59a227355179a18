"""The OMPL planners: each class names its OMPL planner and its budget."""

import math
from hashlib import blake2b
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from pydantic import Field

from benchnav.arrays import Extent, FloatArray
from benchnav.navigation import UNSOLVED, Map, PluginConfig

from ...common.validity_checker import Checker
from .budget import Budget
from .planner import MOST_SEED, OmplConfig, OmplPlanner
from .roadmap import Roadmap, grow
from .search import Query, search


class RangeConfig(OmplConfig):
    """Parameters of planners that grow trees in steps."""

    range: float | None = Field(
        None, gt=0, description="[m] of the longest motion added to a tree; none: OMPL's choice"
    )


class TreePlanner(OmplPlanner):
    """Grows new trees from the start, the goal, or both, for each query."""

    ompl_name: str

    def _search(
        self, map: Map, start: FloatArray, goal: FloatArray, reach: float, checker: Checker,
        seed: int,
    ) -> FloatArray:  # fmt: skip
        query = Query(start, goal, around(map.bounds, start, goal))
        step = self._range(reach, query.bounds)

        def made(geometric: Any, information: Any) -> Any:
            planner = self._planner(geometric, information)
            if step is not None:
                planner.setRange(step)
            return planner

        return search(made, query, checker, seed, self._budget())

    def _planner(self, geometric: Any, information: Any) -> Any:
        return getattr(geometric, self.ompl_name)(information)

    def _range(self, reach: float, bounds: Extent) -> float | None:
        """Return the longest motion [m]; None leaves it to OMPL."""
        longest: float | None = self.config.range
        return longest

    def _budget(self) -> Budget:
        return Budget(self.config.iterations, 0, self.config.seconds)


class RRTConnect(TreePlanner):
    """Two trees that grow towards each other (Kuffner & LaValle 2000)."""

    class Config(RangeConfig):
        """Parameters."""

        iterations: int = Field(
            100_000, ge=1, description="largest number of calls of the termination condition"
        )
        range: float | None = Field(
            None,
            gt=0,
            description="[m] of the longest motion added to a tree; none: four radii of the disc,"
            " at least 1/50 of the diagonal of the map",
        )

    ompl_name = "RRTConnect"

    def _range(self, reach: float, bounds: Extent) -> float | None:
        # OMPL's choice is a fifth of the diagonal; among walls such motions are rarely free
        x0, y0, x1, y1 = bounds
        longest: float | None = self.config.range
        return longest or max(4.0 * reach, 0.02 * math.hypot(x1 - x0, y1 - y0))


class RRTStar(TreePlanner):
    """A tree that is rewired towards shortest paths (Karaman & Frazzoli 2011)."""

    class Config(RangeConfig):
        """Parameters."""

        iterations: int = Field(
            16_000, ge=1, description="largest number of calls of the termination condition"
        )
        improve: int = Field(200, ge=0, description="iterations after the first solution")

    ompl_name = "RRTstar"

    def _budget(self) -> Budget:
        return Budget(self.config.iterations, self.config.improve, self.config.seconds)


class InformedRRTStar(RRTStar):
    """RRT* that samples only where a shorter path can lie (Gammell et al. 2014)."""

    ompl_name = "InformedRRTstar"


class BITStar(TreePlanner):
    """Batches of samples, searched in order of potential path length (Gammell et al. 2015)."""

    class Config(OmplConfig):
        """Parameters."""

        improve: int = Field(1000, ge=0, description="iterations after the first solution")
        batch: int = Field(100, ge=1, description="samples in a batch")

    ompl_name = "BITstar"

    def _range(self, reach: float, bounds: Extent) -> float | None:
        return None

    def _planner(self, geometric: Any, information: Any) -> Any:
        planner = geometric.BITstar(information)
        planner.setSamplesPerBatch(self.config.batch)
        return planner

    def _budget(self) -> Budget:
        return Budget(self.config.iterations, self.config.improve, self.config.seconds)


class PRM(OmplPlanner):
    """A probabilistic roadmap (Kavraki et al. 1996), grown by OMPL.

    If a roadmap does not connect a query, one of twice the size is tried. A shared
    roadmap depends on the map and the radius only, not on the first query.
    """

    class Config(OmplConfig):
        """Parameters."""

        iterations: int = Field(
            400,
            ge=2,
            description="number of calls of the termination condition for the first roadmap",
        )
        doublings: int = Field(
            5, ge=0, le=20, description="how many times the roadmap is doubled if it fails"
        )
        shared: bool = Field(
            True, description="one roadmap for all agents of a radius; else one for each query"
        )

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self._roadmaps: WeakKeyDictionary[Map, dict[tuple[float, int], Roadmap]]
        self._roadmaps = WeakKeyDictionary()

    def _search(
        self, map: Map, start: FloatArray, goal: FloatArray, reach: float, checker: Checker,
        seed: int,
    ) -> FloatArray:  # fmt: skip
        for size in range(self.config.doublings + 1):
            if self.config.shared:
                roadmap = self._shared(map, reach, checker, size)
            else:
                roadmap = self._grown(map, checker, size, seed)
            path = roadmap.path(start, goal, checker)
            if len(path):
                return path
        return UNSOLVED

    def _shared(self, map: Map, reach: float, checker: Checker, size: int) -> Roadmap:
        known = self._roadmaps.setdefault(map, {})
        if (reach, size) not in known:
            known[reach, size] = self._grown(map, checker, size, geometry_seed(map, reach))
        return known[reach, size]

    def _grown(self, map: Map, checker: Checker, size: int, seed: int) -> Roadmap:
        budget = Budget(self.config.iterations << size, 0, self.config.seconds)
        return grow(checker, map.bounds, seed, budget)


def geometry_seed(map: Map, reach: float) -> int:
    """Return a seed that depends only on the map's obstacles and the radius [m]."""
    numbers = np.concatenate([[reach], map.bounds, map.capsules.ravel()])
    digest = blake2b(numbers.tobytes(), digest_size=8).digest()
    return 1 + int.from_bytes(digest, "little") % MOST_SEED


def around(bounds: Extent, *places: FloatArray) -> Extent:
    """Return the bounds, enlarged to contain the places (2,)."""
    points = np.vstack([np.reshape(bounds, (2, 2)), *places])
    (x0, y0), (x1, y1) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    return x0, y0, x1, y1
