"""Encoders agent by agent and ray by ray: plain lists of numbers."""

import math

import numpy as np

from benchnav.arena.solid import Kind
from tests.reference import collision

STEPS = np.linspace(0, 8, 801)  # [m]


def in_frame(heading, vector):
    """Ahead and to the left, as parts along two unit vectors."""
    ahead = np.array([math.cos(heading), math.sin(heading)])
    left = np.array([-math.sin(heading), math.cos(heading)])
    return [float(ahead @ vector), float(left @ vector)]


def ray(kind, distance, goal):
    if np.isfinite(goal):
        return [0, 0, 0, 1, 0, goal / 8]
    if kind in (Kind.DYNAMIC, Kind.NOTHING):
        return [0, 0, 0, 0, 1, 1.0 if kind == Kind.DYNAMIC else distance / 8]
    place = [Kind.AGENT, Kind.WALL, Kind.STATIC].index(kind)
    return [int(k == place) for k in range(4)] + [0, distance / 8]


def mover(kind, distance, approach):
    return [approach / 2, distance / 8] if kind == Kind.DYNAMIC else [0, 1]


def absolute(seen, at):
    return [*seen.position[at] / 10, *seen.velocity[at] / 2, *seen.goal[at] / 10]


def relative(seen, at):
    goal = np.array(in_frame(seen.heading[at], seen.goal[at] - seen.position[at]))
    distance = max(math.hypot(*goal), 1e-9)
    velocity = np.array(in_frame(seen.heading[at], seen.velocity[at]))
    return [*goal / 10, *velocity / 2, *goal / distance]


def paper(seen, at, own, movers):
    rays, numbers = seen.rays, []
    for r in range(7):
        numbers += ray(rays.kind[at][r], rays.distance[at][r], rays.goal[at][r])
    numbers += own(seen, at)
    for r in range(7 if movers else 0):
        numbers += mover(rays.kind[at][r], rays.distance[at][r], rays.approach[at][r])
    return numbers


def nearness(length):
    return math.exp(-length) + math.exp(-length / 4) if length < 8 else 0


def near(seen, at):
    """The numbers of `paper`, with each length over 8 m and each flag for nothing replaced."""
    away = math.hypot(*(seen.goal[at] - seen.position[at]))

    def own(seen, at):
        return [math.exp(-away / 2), away / 10, *relative(seen, at)[2:]]

    numbers = paper(seen, at, own, True)
    for k in [*range(5, 42, 6), *range(49, 62, 2)]:
        numbers[k] = nearness(8 * numbers[k])
    for r in range(7):
        numbers[6 * r + 4] = seen.rays.across[at][r] / 2
    return numbers


def distance_to_edges(points, start, end):
    """(N, E) of points (N, 2)."""
    along, offset = end - start, points[:, None] - start
    t = np.clip((offset * along).sum(2) / np.maximum((along**2).sum(1), 1e-18), 0, 1)
    away = offset - t[..., None] * along
    return np.hypot(away[..., 0], away[..., 1])


def free_way(position, direction, radius, start, end):
    """[m] until the disc meets an edge: a march of 1 cm steps, then halving.

    An edge within reach stops who approaches it and lets go who leaves.
    """

    def distance(t):
        return distance_to_edges(position + np.atleast_1d(t)[:, None] * direction, start, end)

    near = distance(0.0)[0] <= radius
    if (near & (distance(1e-6)[0] < distance(0.0)[0])).any():
        return 0.0
    start, end = start[~near], end[~near]
    met = (distance(STEPS) <= radius).any(1)
    if not met.any():
        return np.inf
    high = STEPS[met.argmax()]
    low = high - STEPS[1]
    for _ in range(20):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if (distance(middle) <= radius).any() else (middle, high)
    return high


def scan(seen, at, radius):
    numbers = []
    count = seen.edges.count[at]
    for k in range(24):
        angle = seen.heading[at] + math.radians(15 * k)
        direction = np.array([math.cos(angle), math.sin(angle)])
        way = free_way(
            seen.position[at], direction, radius, seen.edges.start[at][:count],
            seen.edges.end[at][:count],
        )  # fmt: skip
        numbers.append(math.exp(-way / 2) if way < 8 else 0)
    return numbers


def other(seen, at, radius, k):
    near = seen.neighbours
    if k >= near.count[at]:
        return [0] * 8
    offset = near.position[at][k] - seen.position[at]
    velocity = near.velocity[at][k] - seen.velocity[at]
    distance, reach = max(math.hypot(*offset), 1e-9), radius + near.radius[at][k]
    gap = max(distance - reach, 0)
    return [
        *np.array(in_frame(seen.heading[at], offset)) / distance,
        max(1 - gap / 10, 0), math.exp(-gap),
        *np.array(in_frame(seen.heading[at], velocity)) / 2,
        collision.probability(offset, -velocity, reach),
        int(near.kind[at][k] == Kind.DYNAMIC),
    ]  # fmt: skip


def direction(seen, at, radius, k):
    """The first other whose disc, grown by the own one, the half-line from the agent meets."""
    others, angle = seen.neighbours, seen.heading[at] + math.radians(15 * k)
    ways = []
    for j in range(others.count[at]):
        ahead, left = in_frame(angle, others.position[at][j] - seen.position[at])
        reach = radius + others.radius[at][j]
        if ahead > 0 and abs(left) < reach:
            ways.append((max(ahead - math.sqrt(reach**2 - left**2), 0), j))
    way, first = min(ways, default=(8, -1))
    if way >= 8:
        return [0] * 4
    velocity = others.velocity[at][first] - seen.velocity[at]
    mover = int(others.kind[at][first] == Kind.DYNAMIC)
    return [math.exp(-way / 2), *np.array(in_frame(angle, velocity)) / 2, mover]


def panorama(seen, at, bodies):
    numbers = surround(seen, at, bodies)[: 32 + 4 * 8]
    for k in range(24):
        numbers += direction(seen, at, bodies.radius[at], k)
    return numbers


def meeting(offset, velocity, reach):
    """[s] until two discs touch, from the roots of a polynomial; inf if they never do."""
    if offset @ velocity >= 0:
        return math.inf
    if offset @ offset <= reach**2:
        return 0.0
    roots = np.roots([velocity @ velocity, 2 * offset @ velocity, offset @ offset - reach**2])
    return min(roots.real) if np.isreal(roots).all() else math.inf


def first_contact(positions, velocities, reaches):
    """[s] until the first of the discs (N, 2), moving at (N, 2), comes within reach."""
    times = [meeting(*other) for other in zip(positions, velocities, reaches, strict=True)]
    return min(times, default=math.inf)


def edge_contact(position, velocity, reach, start, end):
    """[s] until a point comes within ``reach`` of an edge: at its ends, or at its two sides."""
    before, after = distance_to_edges(position + np.outer([0, 1e-7], velocity), start, end)
    times = []
    for k, (p, q) in enumerate(zip(start, end, strict=True)):
        if after[k] >= before[k] - 1e-9 * reach * 1e-7:
            continue
        if before[k] <= reach:
            return 0.0
        times += [meeting(position - p, velocity, reach), meeting(position - q, velocity, reach)]
        along = (q - p) / max(math.hypot(*(q - p)), 1e-12)
        across = np.array([-along[1], along[0]])
        if abs(across @ velocity) > 1e-12:
            for side in (-reach, reach):
                t = (side - across @ (position - p)) / (across @ velocity)
                way = along @ (position + t * velocity - p)
                if t >= 0 and 0 <= way <= math.hypot(*(q - p)):
                    times.append(t)
    return min(times, default=math.inf)


def contact(seen, at, bodies, speed, turn, held, back):
    """[s] until a command, held for ``held`` pieces of 0.3 s, leads to a contact."""
    near, edges = seen.neighbours, seen.edges
    count = near.count[at]
    which = np.array([not back or kind == Kind.DYNAMIC for kind in near.kind[at][:count]], bool)
    places, speeds = near.position[at][:count][which], near.velocity[at][:count][which]
    if back:
        speeds = -speeds
    reaches = bodies.radius[at] + near.radius[at][:count][which] + 0.05
    start, end = (getattr(edges, x)[at][: edges.count[at]] for x in ("start", "end"))
    position, angle, now = seen.position[at], seen.heading[at], 0.0
    for piece in range(held + 1):
        left = 0.3 if piece < held else 4.0 - now
        middle = angle + (0.15 * turn if piece < held else 0)
        velocity = speed * np.array([math.cos(middle), math.sin(middle)])
        time = first_contact(position - places - now * speeds, velocity - speeds, reaches)
        if not back:
            edge = edge_contact(position, velocity, bodies.radius[at] + 0.05, start, end)
            time = min(time, edge)
        if time <= left:
            return now + time
        position, angle, now = position + left * velocity, angle + 0.3 * turn, now + left
    return math.inf


def dynamic_window(seen, at, bodies):
    numbers = panorama(seen, at, bodies)
    for held, back in ((1, False), (3, False), (1, True)):
        for speed in np.linspace(0, 1, 5) * bodies.max_speed[at]:
            for turn in np.linspace(-1, 1, 9) * bodies.max_turn_rate[at]:
                time = contact(seen, at, bodies, speed, turn, held, back)
                numbers.append(math.exp(-time / 1.5) if time < 4 else 0)
    return numbers


def surround(seen, at, bodies):
    numbers = relative(seen, at)
    numbers.append(math.exp(-math.hypot(*(seen.goal[at] - seen.position[at])) / 2))
    numbers.append(bodies.max_speed[at] / 2)
    numbers += scan(seen, at, bodies.radius[at])
    for k in range(6):
        numbers += other(seen, at, bodies.radius[at], k)
    return numbers


def encode(name, seen, at, bodies):
    """What the encoder ``name`` says of the agent ``at`` (row, column), before clipping."""
    if name == "surround":
        return surround(seen, at, bodies)
    if name == "panorama":
        return panorama(seen, at, bodies)
    if name == "dynamic-window":
        return dynamic_window(seen, at, bodies)
    if name == "near":
        return near(seen, at)
    own = absolute if name.startswith("paper") else relative
    return paper(seen, at, own, not name.endswith("-static"))
