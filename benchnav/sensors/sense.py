"""All sensors of some agents of a simulation, as arrays of an observation."""

import math
from functools import lru_cache

import numpy as np

from benchnav.arena.sensing import EdgeSensor, NeighbourSensor, RaySensor, Sensing
from benchnav.arrays import AnyArray, FloatArray, IntArray
from benchnav.geometry.hash_grid import collect, fill
from benchnav.geometry.rotation import cos_sin
from benchnav.kernels import kernel_without_allocation
from benchnav.sensors.edges import find_edges
from benchnav.sensors.neighbours import find_neighbours, number_rows, write_forms
from benchnav.sensors.rays import cast_rays
from benchnav.sensors.readings import FORM, Edges, Neighbours, Rays
from benchnav.threads import run_rows
from benchnav.world.simulation import Simulation
from benchnav.world.touch import BRUTE_FORCE

RAYS, NEIGHBOURS, EDGES = "rays", "neighbours", "edges"  # names of the sensors
LEAST_SIDE = 0.1  # [m] of a cell
LEAST = 64  # with fewer agents, a second thread costs more than it saves


def sense(
    simulation: Simulation,
    chosen: IntArray,
    needs: frozenset[str],
    identities: dict[str, IntArray] | None = None,
) -> tuple[Rays | None, Neighbours | None, Edges | None]:
    """Return the current sensor readings of the chosen agents.

    Args:
        simulation: B worlds with equal sensing.
        chosen: (B, An) agent indices; -1 is padding without readings.
        needs: sensors to compute; the result is None for a sensor that the worlds do not have.
        identities: receives, by sensor, a number (B, An, …) of each neighbour and each edge, which
            stays the same during an episode.
    """
    known = {} if identities is None else identities
    sensing: Sensing = simulation.worlds[0].sensing
    crowd = simulation.A > BRUTE_FORCE
    side = 1.0
    if crowd and needs & {RAYS, NEIGHBOURS}:
        side = _cell_side(simulation, sensing, needs)
    if NEIGHBOURS in needs or (crowd and RAYS in needs):
        run_rows(
            _sort_agents, simulation.B, simulation.records, simulation.agents, simulation.hashed,
            simulation.spots, simulation.beyond, side,
        )  # fmt: skip
    rays = neighbours = edges = None
    if RAYS in needs and sensing.rays is not None:
        rays = _rays(simulation, chosen, sensing.rays, side)
    if NEIGHBOURS in needs and sensing.neighbours is not None:
        neighbours = _neighbours(
            simulation, chosen, sensing.neighbours, sensing.occlusion, side, known
        )
    if EDGES in needs and sensing.edges is not None:
        edges = _edges(simulation, chosen, sensing.edges, sensing.occlusion, known)
    return rays, neighbours, edges


def _cell_side(simulation: Simulation, sensing: Sensing, needs: frozenset[str]) -> float:
    """Return a cell side [m] that makes the search fast; it does not change the result."""
    if RAYS in needs and sensing.rays is not None:
        limit = sensing.neighbours.range if sensing.neighbours is not None else 0.0
        return max(0.25 * max(limit, sensing.rays.range), 4.0 * simulation.widest)
    near = float(np.add.reduce(simulation.near, None)) / simulation.near.size
    return max(1.1 * near, 0.5 * simulation.widest, LEAST_SIDE)


@kernel_without_allocation
def _sort_agents(
    low: int, high: int, worlds: AnyArray, agents: AnyArray, hashed: IntArray, spots: AnyArray,
    beyond: FloatArray, side: float,
) -> None:  # fmt: skip
    for b in range(low, high):
        if agents.shape[1] > BRUTE_FORCE:
            fill(agents[b], hashed[b], spots[b], side)
            worlds[b].cells = side
            beyond[b] = -1.0
        else:
            collect(agents[b], hashed[b], spots[b])


def ray_angles(sensor: RaySensor) -> FloatArray:
    """Return the ray angles (R,) [rad] from the heading, from right to left."""
    if sensor.count == 1:
        return np.zeros(1)
    whole = sensor.fan >= 2.0 * math.pi - 1e-9
    return np.linspace(-0.5 * sensor.fan, 0.5 * sensor.fan, sensor.count, endpoint=not whole)


@lru_cache(maxsize=64)
def _fan(sensor: RaySensor) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the ray angles (R,), and the rays' directions, padded to a multiple of 8."""
    angle = ray_angles(sensor)
    padded = np.concatenate([angle, np.full(-len(angle) % 8, angle[-1])])
    fan_x, fan_y = np.array([cos_sin(a) for a in padded]).T.copy()
    return angle, fan_x, fan_y


def _rays(simulation: Simulation, chosen: IntArray, sensor: RaySensor, side: float) -> Rays:
    angle, fan_x, fan_y = _fan(sensor)
    shape = (*chosen.shape, len(angle))
    distance, goal = np.empty(shape), np.empty(shape)
    distance.fill(sensor.range)
    goal.fill(np.inf)
    out = Rays(
        angle.copy(), distance, np.zeros(shape, np.int8), np.zeros(shape), goal,
        np.zeros(chosen.shape), np.zeros(shape),
    )  # fmt: skip
    s = simulation
    run_rows(
        cast_rays, chosen.size, chosen, fan_x, fan_y, float(sensor.range), int(sensor.circle),
        side, s.widest, s.most_shapes, s.sees, s.records, s.agents, s.bodies, s.shapes, s.capsules,
        s.start, s.item, s.hashed, s.spots, out.distance, out.kind, out.approach,
        out.across, out.goal, out.radius, least=LEAST,
    )  # fmt: skip
    return out


def _neighbours(
    simulation: Simulation, chosen: IntArray, sensor: NeighbourSensor, occlusion: bool, side: float,
    identities: dict[str, IntArray],
) -> Neighbours:  # fmt: skip
    shape = (*chosen.shape, sensor.count)
    s = simulation
    # without shapes, all four are one array of zeros: more of them take time
    form = [np.zeros(shape) for _ in FORM] if s.shaped else [np.zeros(shape)] * len(FORM)
    out = Neighbours(
        np.empty((*shape, 2)), np.empty((*shape, 2)), np.empty(shape), np.empty(shape, np.int8),
        np.empty(chosen.shape, np.int64), *form,
    )  # fmt: skip
    row = np.empty((s.B, s.A), np.int64)
    identities[NEIGHBOURS] = np.empty(shape, np.int64)
    readings = (out.position, out.velocity, out.radius, out.kind, out.count)
    number_rows(0, s.B, chosen, s.agents, row, *readings)
    run_rows(
        find_neighbours, row.size, row, float(sensor.range), occlusion, side, s.sees,
        s.records, s.bodies, s.shapes, s.capsules, s.start, s.item, s.hashed, s.spots,
        s.near, s.listed, s.beyond, *readings, identities[NEIGHBOURS], least=LEAST,
    )  # fmt: skip
    if s.shaped:
        write_forms(
            0, s.B, s.agents, out.count, identities[NEIGHBOURS], out.heading, out.half_length,
            out.half_width, out.rounding,
        )  # fmt: skip
    return out


def _edges(
    simulation: Simulation, chosen: IntArray, sensor: EdgeSensor, occlusion: bool,
    identities: dict[str, IntArray],
) -> Edges:  # fmt: skip
    shape = (*chosen.shape, sensor.count)
    points = [np.zeros((*shape, 2)) for _ in range(4)]
    out = Edges(
        points[0], points[1], points[2], points[3], np.zeros(shape, np.bool_),
        np.zeros(shape, np.bool_), np.zeros(chosen.shape, np.int64),
    )  # fmt: skip
    identities[EDGES] = np.empty(shape, np.int64)
    s = simulation
    run_rows(
        find_edges, chosen.size, chosen, float(sensor.range), s.widest_disc, occlusion,
        s.records, s.agents, s.bodies, s.shapes, s.capsules, s.start, s.item, out.start, out.end,
        out.before, out.after, out.start_convex, out.end_convex, out.count, identities[EDGES],
        least=LEAST,
    )  # fmt: skip
    return out
