"""A probabilistic roadmap: grown by OMPL, searched here.

OMPL's own PRM polls its termination condition from a second thread while it solves,
which deadlocks with a Python condition and is not reproducible with a timed one.
Growing only is safe and reproducible, and a query is a graph search.
"""

import heapq
import math
from dataclasses import dataclass

import numpy as np

from benchnav.arrays import Extent, FloatArray

from ...common.validity_checker import Checker
from .budget import Budget
from .search import load, space_information

_TRIED = 60  # milestones, nearest first, that may be connected to a start or goal
_JOINED = 12  # number of connections after which this stops


@dataclass(frozen=True, eq=False)
class Roadmap:
    """Milestones, and the free straight motions between them."""

    points: FloatArray  # (N, 2) [m]
    links: tuple[tuple[int, ...], ...]  # (N,) the milestones connected to each milestone

    def path(self, start: FloatArray, goal: FloatArray, checker: Checker) -> FloatArray:
        """Return the shortest path (W, 2) [m] through milestones; (0, 2) if there is none."""
        ends = self._joined(goal, checker)
        begins = self._joined(start, checker) if ends else {}
        remaining = np.hypot(*(self.points - goal).T).tolist()
        best = begins.copy()
        parent: dict[int, int] = {}
        queue = [(d + remaining[n], n) for n, d in best.items()]
        heapq.heapify(queue)
        goal_cost, last = math.inf, -1
        while queue and queue[0][0] < goal_cost:
            estimate, n = heapq.heappop(queue)
            if estimate > best[n] + remaining[n]:
                continue
            if n in ends and best[n] + ends[n] < goal_cost:
                goal_cost, last = best[n] + ends[n], n
            for m in self.links[n]:
                cost = best[n] + math.dist(self.points[n], self.points[m])
                if cost < best.get(m, math.inf):
                    best[m], parent[m] = cost, n
                    heapq.heappush(queue, (cost + remaining[m], m))
        return self._traced(start, goal, last, parent)

    def _traced(
        self, start: FloatArray, goal: FloatArray, last: int, parent: dict[int, int]
    ) -> FloatArray:
        if last < 0:
            return np.zeros((0, 2))
        chain = [last]
        while chain[-1] in parent:
            chain.append(parent[chain[-1]])
        return np.vstack([start, self.points[chain[::-1]], goal])

    def _joined(self, place: FloatArray, checker: Checker) -> dict[int, float]:
        """Return milestone → distance [m] for near milestones that can be reached straight."""
        distance = np.hypot(*(self.points - place).T)
        found: dict[int, float] = {}
        for n in np.argsort(distance, kind="stable")[:_TRIED].tolist():
            x, y = self.points[n].tolist()
            if checker.motion_is_free(float(place[0]), float(place[1]), x, y):
                found[n] = float(distance[n])
                if len(found) == _JOINED:
                    break
        return found


def grow(checker: Checker, bounds: Extent, seed: int, budget: Budget) -> Roadmap:
    """Return a roadmap of the free plane within ``bounds``, equal for equal seeds."""
    base, geometric, util = load()
    util.RNG.setSeed(seed)
    information = space_information(base, bounds, checker)
    planner = geometric.PRM(information)
    planner.setProblemDefinition(base.ProblemDefinition(information))
    planner.setup()
    planner.growRoadmapPtc(base.PlannerTerminationCondition(budget))
    data = base.PlannerData(information)
    planner.getPlannerData(data)
    count = data.numVertices()
    points = [data.getVertex(n).getState()[0:2] for n in range(count)]
    links = tuple(tuple(data.getEdges(n)) for n in range(count))
    return Roadmap(np.array(points, np.float64).reshape(-1, 2), links)
