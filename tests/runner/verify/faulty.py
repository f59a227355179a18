"""Seeds faults into kernels, one at a time, and prints what the twin and the referee find.

Run as a program of its own with NUMBA_DISABLE_JIT=1: interpreted kernels call what their
module holds now. Each fault is in the simulation and in the re-simulation alike, so
that all but the twin agree.
"""

import json
import math
import sys
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[3]))

import numpy as np

from benchnav.arena.body import Body, Law, LawKind
from benchnav.arena.solid import Kind
from benchnav.arena.world import ContactRule
from benchnav.episode.episode import Identity
from benchnav.runner.rollouts.recorder import Recorder
from benchnav.verify.episode_check import compare
from benchnav.verify.finding import Report
from benchnav.verify.part_check import Pair
from benchnav.verify.reference.fcl_check import judge
from benchnav.verify.reference.reference_check import check_twin
from benchnav.verify.resimulation import resimulate
from benchnav.world import contacts, entry, motion_limits, simulation, step, touch
from benchnav.world.simulation import Simulation
from tests.worlds import agents, back_and_forth, box, limited_world, random_world, walls, world


def press_scene():
    """A world in which a moving obstacle squeezes an agent against a wall."""
    away = Law(LawKind.RELOCATE, np.array([0.0, 0.4]), np.array([[5.0, 5.0], [10.0, 10.0]]))
    shelf = Body(box(Kind.STATIC, 0, 0, 1, 1), away)
    press = back_and_forth(box(Kind.DYNAMIC, 0, 0, 0.5, 0.5), [15.2, 4], [19.2, 4], 1.0)
    start = [[9.0, 10.0], [16.0, 10.0], [17.8, 4.0]]
    crew = agents(start, [[18.0, 10.0], [2.0, 10.0], [25.0, 4.0]])
    return world(crew, [walls(20.0)], [press, shelf], steps=25)


def scenes():
    """Worlds in which everything happens that a kernel does."""
    yield limited_world(3, steps=25)
    for seed, (unicycle, contact) in enumerate(
        [(True, ContactRule.SLIDE), (False, ContactRule.STOP), (False, ContactRule.END)]
    ):
        yield random_world(seed, contact=contact, unicycle=unicycle, steps=25)
    yield press_scene()
    drawn = random_world(7, 6, steps=25)
    place = drawn.agents.start[[0, 1, 0, 3, 4, 4]]
    late = replace(drawn.agents, start=place, enters=np.array([0, 0, 0.2, 1.0, 2.1, 2.1]))
    yield replace(drawn, agents=late)


def play(drawn, seed, twists=False):
    """An episode of noisy commands towards the goals."""
    batch = Simulation([drawn])
    recorder = Recorder(batch)
    rng = np.random.default_rng(seed)
    twist = np.full((1, batch.A), twists)
    recorder.record_kinds(twist)
    recorder.record_state()
    while batch.running.any():
        away = batch.goal - batch.position
        length = np.maximum(np.linalg.norm(away, axis=-1, keepdims=True), 1e-9)
        command = 2.5 * away / length + 0.5 * rng.normal(size=away.shape)
        executed = batch.step(command, twist)
        recorder.record_commands(command, executed, 0.0)
        recorder.record_state()
    identity = Identity("a/b@1", "", "test", seed, "known", "noise")
    return recorder.episodes([identity], 0.0, "", True, [()])[0]


def found(enough=lambda twin, referee: False):
    """What the twin and the referee say of all scenes; re-simulation sees nothing.

    No further scene is played once what they found is ``enough``.
    """
    again, twin, referee = Report(), Report(), Report()
    for seed, drawn in enumerate(scenes()):
        episode = play(drawn, seed)
        ((new, wrong, touched),) = resimulate([(drawn, episode)])
        assert not wrong
        compare(episode, new, "", again)
        check_twin(drawn, episode, "", twin)
        judge(Pair(episode, new, touched, ""), referee)
        if enough(twin.findings, referee.findings):
            break
    assert again.clean  # the fault is in both
    return [[finding.what for finding in report.findings][:2] for report in (twin, referee)]


@contextmanager
def patched(module, name, value):
    genuine = getattr(module, name)
    setattr(module, name, value(genuine) if callable(genuine) else value)
    try:
        yield
    finally:
        setattr(module, name, genuine)


def shorter(share):
    """A touch that comes too late: bodies are taken for smaller ones."""
    return lambda genuine: (
        lambda px, py, wx, wy, reach, *rest: genuine(px, py, wx, wy, share * reach, *rest)
    )


FAULTS = {
    "step: a twist is driven along the old heading": (
        step, "planar_velocity",
        lambda _: lambda d0, d1, turning, heading, h: (
            (d0 * math.cos(heading), d0 * math.sin(heading)) if turning else (d0, d1)
        ),
    ),
    "step: speed is not limited": (
        step, "limited",
        lambda genuine: lambda c0, c1, t, u, heading, top, *rest: genuine(
            c0, c1, t, u, heading, 2.0 * top, *rest
        ),
    ),
    "step: headings are not wrapped at all, and a tenth too far": (
        step, "wrap", lambda genuine: lambda angle: 1.1 * angle,
    ),
    "step: the world goes by a law of its own": (
        step, "body_at",
        lambda genuine: lambda body, knots, time: genuine(body, knots, 0.99 * time),
    ),
    "step: what is re-placed asks nobody": (step, "_within", lambda _: lambda *_: False),
    "entry: agents do not wait for room": (entry, "_is_free", lambda _: lambda *_: True),
    "entry: agents come a decision early": (
        entry, "SOON", 0.2,
    ),
    "limits: bodies brake and speed up a little faster": (
        motion_limits, "approached",
        lambda genuine: lambda d0, d1, t0, t1, a, d, dt: genuine(
            d0, d1, t0, t1, 1.01 * a, 1.01 * d, dt
        ),
    ),
    "limits: an Ackermann body is taken for a unicycle": (
        motion_limits, "_steered",
        lambda _: lambda v, w, d0, body, dt: motion_limits._wheeled(v, w, d0, 0.0, body, dt),
    ),
    "limits: the wheels are nearer to each other": (
        simulation, "limit_records",
        lambda genuine: lambda agents: genuine(
            replace(agents, track_width=0.9 * agents.track_width)
        ),
    ),
    "contact: walls and obstacles are thinner": (touch, "capsule_time", shorter(0.98)),
    "contact: agents are smaller": (
        touch, "disc_time",
        lambda genuine: lambda fx, fy, wx, wy, reach: genuine(fx, fy, wx, wy, 0.98 * reach),
    ),
    "contact: others are taken to stand": (
        touch, "pair_time",
        lambda _: lambda a, b: touch.disc_time(a.x - b.x, a.y - b.y, a.vx, a.vy,
                                               a.radius + b.radius),
    ),
    "contact: one slides off at an angle": (
        contacts, "_unit", lambda genuine: lambda dx, dy: genuine(dx - 0.1 * dy, dy + 0.1 * dx),
    ),
    "contact: a contact lasts too long": (contacts, "RELEASE", 0.1),
    "contact: depths are not seen": (
        contacts, "_gap", lambda genuine: lambda *args: max(genuine(*args), 0.0),
    ),
    "contact: an event starts too late": (
        contacts, "_record",
        lambda genuine: lambda i, code, time, *rest: genuine(i, code, time + 1e-3, *rest),
    ),
    "contact: nobody is charged": (
        contacts, "_record",
        lambda genuine: lambda i, code, time, closing, charged, *rest: genuine(
            i, code, time, closing, False, *rest
        ),
    ),
}  # fmt: skip
JUDGED = {
    "contact: walls and obstacles are thinner", "contact: agents are smaller",
    "contact: others are taken to stand", "contact: depths are not seen",
    "contact: a contact lasts too long", "step: what is re-placed asks nobody",
}  # fmt: skip
"""Faults that the referee sees, too."""

if __name__ == "__main__":
    said = {"": found()}
    for name, (module, attribute, value) in FAULTS.items():
        judged = name in JUDGED
        with patched(module, attribute, value):
            said[name] = found(
                lambda twin, referee, judged=judged: twin and (referee or not judged)
            )
    print(json.dumps(said))
