"""Plan for all agents of a world, one after the other; each plan avoids the earlier ones.

Prioritised planning (M. Erdmann and T. Lozano-Pérez, "On multiple moving objects",
Algorithmica 2, 1987). An agent without a plan is first in the next round (M. Bennewitz,
W. Burgard and S. Thrun, "Finding and optimizing solvable priority schemes for decoupled
path planning techniques for teams of mobile robots", Robotics and Autonomous Systems 41,
2002). If an order occurs again, a random order is drawn. In some rounds, plans also avoid for a
while the start places of agents that are not planned yet.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from benchnav.arena.world import World
from benchnav.arrays import FloatArray

from .drive import follow
from .reach import reach, to_goal
from .scene import Scene, Traffic, scene
from .search import Effort, search

ROUNDS = 24  # at most
COURTESY = (0.0, 1.0, 3.0)  # [s] that starts of agents still unplanned are kept free, by round
USUAL = Effort()
ALONE = Effort(nodes=600_000, cell=0.1, speeds=5, turns=9)  # before an agent is given up


@dataclass(frozen=True, eq=False)
class Plan:
    """The plan of one agent."""

    commands: FloatArray  # (T, 2) twists [m/s, rad/s]; none where no way was found
    path: FloatArray  # (K+1, 2) [m] at every tick, the agent staying at the end
    ticks: int  # substeps after which it is gone: it may arrive during the last of its plan

    @property
    def found(self) -> bool:
        """Whether the plan reaches the goal."""
        return len(self.commands) > 0


def plans(world: World, seed: int) -> Iterator[list[Plan]]:
    """Plans for the agents of ``world``, round by round, until one finds a way for all it can.

    ``seed`` draws the orders that are tried when the reasoned ones are used up.
    """
    planner = Planner(scene(world))
    rng = np.random.default_rng(seed)
    order, tried = planner.longest_first(), set[tuple[float, ...]]()
    for k in range(ROUNDS):
        courtesy = COURTESY[k % len(COURTESY)]
        if (courtesy, *order) in tried:
            order = [int(i) for i in rng.permutation(len(order))]
        tried.add((courtesy, *order))
        made = planner.round(order, courtesy)
        yield made
        failed = [i for i in order if not made[i].found and i not in planner.hopeless]
        if not failed:
            return
        order = failed + [i for i in order if i not in failed]


class Planner:
    """The rounds of one world."""

    def __init__(self, known: Scene) -> None:
        self.scene = known
        self.ways = [reach(known.ground[task.radius], known.bounds, task) for task in known.tasks]
        self.hopeless: set[int] = set()  # no plan found, although none was made before theirs

    def longest_first(self) -> list[int]:
        """Agents by the length of their way."""
        length = [
            float(to_goal(ways, task.x, task.y))
            for ways, task in zip(self.ways, self.scene.tasks, strict=True)
        ]
        return sorted(range(len(length)), key=lambda i: (-length[i], i))

    def round(self, order: list[int], courtesy: float) -> list[Plan]:
        """Return the plan of each agent, made in ``order``; without one, it stands still."""
        made = {i: self.standing(i) for i in self.hopeless}
        for i in order:
            if i not in made:
                waiting = [j for j in order if j not in made and j != i]
                made[i] = self.plan(i, made, waiting, courtesy)
        return [made[i] for i in range(len(order))]

    def plan(self, i: int, made: dict[int, Plan], waiting: list[int], courtesy: float) -> Plan:
        """The plan of agent i around those made and, for ``courtesy`` [s], those waiting."""
        others = dict(made)
        if courtesy > 0.0:
            others |= {j: self.standing(j, courtesy) for j in waiting}
        found = self.searched(i, others, USUAL)
        if not found.found and others.keys() <= self.hopeless:
            found = self.searched(i, others, ALONE)
            if not found.found:
                self.hopeless.add(i)
        return found

    def searched(self, i: int, others: dict[int, Plan], effort: Effort) -> Plan:
        """The plan of agent i around ``others``; it stands where there is none."""
        task, known = self.scene.tasks[i], self.scene
        ground, traffic = known.ground[task.radius], self.traffic(others)
        commands = search(task, ground, known.movers, traffic, self.ways[i], effort)
        if len(commands) == 0:
            return self.standing(i)
        path = np.empty((len(known.movers.place), 2))
        follow(task, commands, path)
        return Plan(commands, path, len(commands) * task.substeps)

    def standing(self, i: int, seconds: float = np.inf) -> Plan:
        """Agent i stays where it starts."""
        task, length = self.scene.tasks[i], len(self.scene.movers.place)
        path = np.tile(np.array([task.x, task.y]), (length, 1))
        return Plan(np.zeros((0, 2)), path, int(min(seconds / task.h, length - 1)))

    def traffic(self, others: dict[int, Plan]) -> Traffic:
        """Plans as those who come later see them."""
        length = len(self.scene.movers.place)
        place = np.array([plan.path for plan in others.values()]).reshape(-1, length, 2)
        ticks = np.array([plan.ticks for plan in others.values()], np.int64)
        radius = np.array([self.scene.tasks[i].radius for i in others])
        return Traffic(place, ticks, radius)
