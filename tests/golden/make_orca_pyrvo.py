"""Writes orca_pyrvo_steps.npz: single steps of pyrvo 0.4.3 (RVO2 in float32), inputs and outputs.

Run it with an interpreter that has pyrvo 0.4.3 and numpy:
``python tests/golden/make_orca_pyrvo.py``. Scenes are crowds of random density, with and
without polygons (convex, concave, an inside-out room) around them. Each agent's
neighbours and edges are stored as pyrvo itself chose and ordered them.
"""

from pathlib import Path

import numpy as np

TARGET = Path(__file__).with_name("orca_pyrvo_steps.npz")
AGENTS, NEIGHBOURS, EDGES = 40, 8, 12
HORIZON, EDGE_HORIZON, DT = 4.0, 3.0, 0.25

BOX = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
TRIANGLE = [(0.0, -1.5), (2.0, 1.0), (-1.0, 0.5)]
ANGLE = [(0.0, 0.0), (3.0, 0.0), (3.0, 1.0), (1.0, 1.0), (1.0, 3.0), (0.0, 3.0)]
CROSS = [
    (1, -3), (1, -1), (3, -1), (3, 1), (1, 1), (1, 3),
    (-1, 3), (-1, 1), (-3, 1), (-3, -1), (-1, -1), (-1, -3),
]  # fmt: skip
SLIVER = [(-2.0, 0.0), (2.0, 0.0), (2.0, 0.25), (-2.0, 0.25)]


def room(half):
    """A square seen from inside: clockwise, so that the solid is outside."""
    return [(-half, -half), (-half, half), (half, half), (half, -half)]


def moved(polygon, x, y, scale=1.0):
    return [(x + scale * px, y + scale * py) for px, py in polygon]


SCENES = [
    (6.0, []),
    (3.5, []),
    (2.2, []),
    (6.0, [moved(BOX, 0, 0), moved(TRIANGLE, 3, 3)]),
    (5.0, [moved(ANGLE, -1, -1), moved(SLIVER, 0, 4)]),
    (5.0, [moved(CROSS, 0, 0)]),
    (4.0, [room(4.5), moved(BOX, 2, 2, 0.5)]),
    (2.5, [room(2.5)]),
]


def crossings(polygon, x, y):
    inside = False
    for (ax, ay), (bx, by) in zip(polygon, polygon[1:] + polygon[:1], strict=True):
        if (ay > y) != (by > y) and x < ax + (y - ay) * (bx - ax) / (by - ay):
            inside = not inside
    return inside


def is_free(polygons, x, y):
    for polygon in polygons:
        area = sum(
            ax * by - bx * ay
            for (ax, ay), (bx, by) in zip(polygon, polygon[1:] + polygon[:1], strict=True)
        )
        if crossings(polygon, x, y) == (area > 0):
            return False
    return True


def drawn(generator, half, polygons):
    """(AGENTS, 2) places outside the solids, exact in float32, some of them touching."""
    places = []
    while len(places) < AGENTS:
        x, y = np.float32(generator.uniform(-half, half, 2))
        if is_free(polygons, x, y):
            places.append((x, y))
    return np.array(places, np.float64)


def unit(a, b):
    d = np.array(b, np.float64) - np.array(a, np.float64)
    return d / np.hypot(*d)


def is_convex(a, b, c):
    """A vertex that the tree of RVO2 put into a straight edge counts as convex."""
    (ax, ay), (bx, by), (cx, cy) = a, b, c
    return (ax - cx) * (by - ay) - (bx - ax) * (ay - cy) >= -1e-5


def edges_of(simulator, agent, row):
    def at(vertex):
        return simulator.get_obstacle_vertex(vertex).to_tuple()

    after, before = simulator.get_next_obstacle_vertex, simulator.get_prev_obstacle_vertex
    count = min(simulator.get_agent_num_obstacle_neighbors(agent), EDGES)
    for k in range(count):
        first = simulator.get_agent_obstacle_neighbor(agent, k)
        second = after(first)
        a, b, c, d = at(before(first)), at(first), at(second), at(after(second))
        row["start"][agent, k], row["end"][agent, k] = b, c
        row["before"][agent, k], row["after"][agent, k] = unit(a, b), unit(c, d)
        row["start_convex"][agent, k] = is_convex(a, b, c)
        row["end_convex"][agent, k] = is_convex(b, c, d)
    row["edge_count"][agent] = simulator.get_agent_num_obstacle_neighbors(agent)


def scene(seed, half, polygons):
    import pyrvo

    generator = np.random.default_rng(seed)
    row = {
        "position": drawn(generator, half, polygons),
        "velocity": np.float32(generator.normal(0, 0.6, (AGENTS, 2))).astype(float),
        "wanted": np.float32(generator.normal(0, 0.9, (AGENTS, 2))).astype(float),
        "radius": np.float32(generator.uniform(0.15, 0.4, AGENTS)).astype(float),
        "limit": np.float32(generator.uniform(0.8, 1.6, AGENTS)).astype(float),
        "neighbour": np.full((AGENTS, NEIGHBOURS), -1),
        "edge_count": np.zeros(AGENTS, int),
        **{k: np.zeros((AGENTS, EDGES, 2)) for k in ("start", "end", "before", "after")},
        **{k: np.zeros((AGENTS, EDGES), bool) for k in ("start_convex", "end_convex")},
    }
    simulator = pyrvo.RVOSimulator()
    simulator.set_time_step(DT)
    simulator.set_agent_defaults(5.0, NEIGHBOURS, HORIZON, EDGE_HORIZON, 0.25, 1.0)
    for polygon in polygons:
        simulator.add_obstacle([(float(x), float(y)) for x, y in polygon])
    simulator.process_obstacles()

    def vector(values):
        return float(values[0]), float(values[1])

    for i in range(AGENTS):
        simulator.add_agent(vector(row["position"][i]))
        simulator.set_agent_radius(i, float(row["radius"][i]))
        simulator.set_agent_max_speed(i, float(row["limit"][i]))
        simulator.set_agent_velocity(i, vector(row["velocity"][i]))
        simulator.set_agent_pref_velocity(i, vector(row["wanted"][i]))
    simulator.do_step()
    for i in range(AGENTS):
        for k in range(simulator.get_agent_num_agent_neighbors(i)):
            row["neighbour"][i, k] = simulator.get_agent_agent_neighbor(i, k)
        edges_of(simulator, i, row)
    answers = [simulator.get_agent_velocity(i) for i in range(AGENTS)]
    row["answer"] = np.array([answer.to_tuple() for answer in answers])
    return row


def main():
    rows = [scene(seed, *which) for seed, which in enumerate(SCENES)]
    stacked = {name: np.stack([row[name] for row in rows]) for name in rows[0]}
    assert stacked["edge_count"].max() <= EDGES, stacked["edge_count"].max()
    constants = {"dt": DT, "horizon": HORIZON, "edge_horizon": EDGE_HORIZON}
    np.savez_compressed(TARGET, **stacked, **constants)


if __name__ == "__main__":
    main()
