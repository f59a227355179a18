"""The slow, obvious twin of `benchnav.sensors.noise`: one agent, one reading, plain numbers."""

import math
from statistics import NormalDist

from benchnav.arena.solid import Kind

WORD = (1 << 64) - 1
ROTATIONS = (16, 42, 12, 31, 16, 32, 24, 21)
RAY, NEIGHBOUR, MISSED, FALSE_ALARM, EDGE, ODOMETRY, CORRECTION = range(7)


def threefry(key, counter):
    """Threefry-2x64-20 of Random123, in whole numbers."""
    keys = (*key, key[0] ^ key[1] ^ 0x1BD11BDAA9FC1A22)
    a, b = (counter[0] + keys[0]) & WORD, (counter[1] + keys[1]) & WORD
    for turn in range(20):
        r = ROTATIONS[turn % 8]
        a = (a + b) & WORD
        b = ((b << r) | (b >> (64 - r))) & WORD ^ a
        if turn % 4 == 3:
            n = turn // 4 + 1
            a, b = (a + keys[n % 3]) & WORD, (b + keys[(n + 1) % 3] + n) & WORD
    return a, b


class Draws:
    """The draws of one agent at one decision."""

    def __init__(self, key, step, agent):
        self.key, self.high = tuple(map(int, key)), (step << 32) | agent

    def words(self, channel, index=0):
        return threefry(self.key, (self.high, (channel << 56) | (int(index) % (1 << 56))))

    def uniform(self, channel, index=0, word=1):
        return (self.words(channel, index)[word] >> 11) / 2**53

    def normals(self, channel, index=0, word=0):
        """Two numbers."""
        value = self.words(channel, index)[word]
        return [NormalDist().inv_cdf((half + 0.5) / 2**32) for half in divmod(value, 1 << 32)]


def rotated(p, angle):
    c, s = math.cos(angle), math.sin(angle)
    return c * p[0] - s * p[1], s * p[0] + c * p[1]


def placed(point, own, error):
    """Where a point seems to be: relative to the estimate, turned by its heading error."""
    dx, dy = rotated((point[0] - own[0], point[1] - own[1]), error[2])
    return own[0] + error[0] + dx, own[1] + error[1] + dy


def drifted(error, before, after, noise, draws):
    """The pose error after one decision without correction; poses are (x, y, heading)."""
    way = (after[0] - before[0], after[1] - before[1])
    d = math.hypot(*way)
    turned = abs(math.remainder(after[2] - before[2], 2 * math.pi))
    slip, turn = draws.normals(ODOMETRY)
    turn *= math.hypot(noise.heading_noise * math.sqrt(d), noise.turning_noise * math.sqrt(turned))
    stretch = 1.0 + noise.distance_noise * slip / math.sqrt(d) if d else 1.0
    measured = rotated(way, error[2] + turn / 2)
    return (
        error[0] + stretch * measured[0] - way[0],
        error[1] + stretch * measured[1] - way[1],
        error[2] + turn,
    )


def corrected(noise, draws):
    """The pose error after a correction."""
    x, y = draws.normals(CORRECTION)
    return (
        noise.correction_position_noise * x,
        noise.correction_position_noise * y,
        noise.correction_heading_noise * draws.normals(CORRECTION, word=1)[0],
    )


def ray(distance, kind, approach, across, angle, limit, noise, draws, r, rays):
    """(distance, kind, approach, across) of ray number r of ``rays``."""
    shift, faster = draws.normals(RAY, r)
    if kind != Kind.NOTHING:
        deviation = noise.noise + noise.relative_noise * distance
        distance += (deviation + noise.quadratic_noise * distance**2) * shift
        approach += noise.approach_noise * faster * (kind == Kind.DYNAMIC)
        across += noise.approach_noise * draws.normals(RAY, rays + r)[0] * (kind == Kind.DYNAMIC)
    lost = draws.uniform(RAY, r) < noise.dropout or abs(angle) > noise.field_of_view / 2
    if lost or distance >= limit:
        return limit, int(Kind.NOTHING), 0.0, 0.0
    return max(distance, 0.0), kind, approach, across


def in_view(point, own, heading, view):
    bearing = math.atan2(point[1] - own[1], point[0] - own[0]) - heading
    return view >= 2 * math.pi or abs(math.remainder(bearing, 2 * math.pi)) <= view / 2


def neighbours(exact, own, heading, radius, limit, most, noise, error, draws):
    """[(position, velocity, radius, kind)], from [(identity, position, velocity, radius, kind)]."""
    found = []
    for name, position, velocity, size, kind in exact:
        if not in_view(position, own, heading, noise.field_of_view):
            continue
        if draws.uniform(MISSED, name, word=0) < noise.missed:
            continue
        nx, ny = draws.normals(NEIGHBOUR, name)
        mx, my = draws.normals(NEIGHBOUR, name, word=1)
        p = (position[0] + noise.position_noise * nx, position[1] + noise.position_noise * ny)
        v = (velocity[0] + noise.velocity_noise * mx, velocity[1] + noise.velocity_noise * my)
        found.append((p, v, size, kind))
    if draws.uniform(FALSE_ALARM, 0, word=0) < noise.false_alarms:
        bearing = (draws.uniform(FALSE_ALARM, 0) - 0.5) * noise.field_of_view
        far = limit * math.sqrt(draws.uniform(FALSE_ALARM, 1, word=0))
        dx, dy = rotated((far, 0.0), heading + bearing)
        v = [noise.velocity_noise * n for n in draws.normals(FALSE_ALARM, 1, word=1)]
        found.append(((own[0] + dx, own[1] + dy), v, radius, int(Kind.AGENT)))
    found.sort(key=lambda reading: math.dist(reading[0], own))
    return [
        (placed(p, own, error), rotated(v, error[2]), size, kind)
        for p, v, size, kind in found[:most]
    ]
