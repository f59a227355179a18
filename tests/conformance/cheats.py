"""Navigators that try to learn what they are not told: where the pillar stands that no map shows.

Each is an honest attempt by the means that its name says. What it learns it tells in its
remarks, as the two coordinates, so that a test can see that it really knows.
"""

import contextlib
import contextvars
import ctypes
import gc
import hashlib
import inspect
import os
import re
import struct
import sys
import threading
import types
from collections import deque
from pathlib import Path

import numpy as np
from pydantic import Field

from benchnav.navigation.navigator import Navigator, PluginConfig

ENOUGH = 400_000  # objects that a search looks at
CLUE = "BENCHNAV_TEST_CLUE"  # a variable of the environment, as a run might have


class Cheat(Navigator):
    """Walks straight at its goal, and looks about before it does."""

    seen = None  # what it learned

    def reset(self, briefings, rows):
        self.briefing = briefings[0]
        self.learn(self.look(briefings[0]))

    def act(self, observation):
        self.learn(self.peek(observation))
        way = observation.goal - observation.position
        return way / np.maximum(np.linalg.norm(way, axis=2, keepdims=True), 1e-9)

    def look(self, briefing):
        return None

    def peek(self, observation):
        return None

    def remarks(self, row):
        return [self.seen] if self.seen else []

    def learn(self, found):
        self.seen = self.seen or found


def pillar_in(thing):
    """The pillar's place where ``thing`` is something of the simulator that knows it, as text."""
    kind = type(thing).__name__
    try:
        if kind == "Simulation":
            thing, kind = thing.worlds[0], "World"
        if kind == "Episode":
            thing, kind = thing.world, "World"
        if kind == "World":
            thing, kind = thing.solids[-1], "Solid"
        if kind == "Solid" and thing.is_disc:
            return f"{thing.center[0]!r} {thing.center[1]!r}"
    except Exception:
        return None
    return None


def search(roots, *, state_of_modules=False):
    """Everything that can be reached by attributes, items, cells and defaults from ``roots``."""
    waiting, met = deque(roots), set()
    while waiting and len(met) < ENOUGH:
        thing = waiting.popleft()  # the nearest first
        if id(thing) in met or isinstance(thing, (str, bytes, int, float, types.FrameType)):
            continue
        met.add(id(thing))
        found = pillar_in(thing)
        if found:
            return found
        waiting.extend(parts_of(thing, state_of_modules))
    return None


def parts_of(thing, state_of_modules):
    parts = []
    if isinstance(thing, dict):
        parts += [*thing.keys(), *thing.values()]
    elif isinstance(thing, (list, tuple, set, frozenset)):
        parts += thing
    if isinstance(thing, types.ModuleType) and not state_of_modules:
        return parts
    with contextlib.suppress(Exception):
        parts += vars(thing).values()
    names = ["__self__", "__func__", "__wrapped__", "func", "args", "fget", "base", "seed_seq",
             "bit_generator", "__defaults__", "__kwdefaults__", "_target", "_args"]  # fmt: skip
    slots = getattr(type(thing), "__slots__", ())
    names += slots if isinstance(slots, tuple) else ()
    for name in names:
        try:
            parts.append(getattr(thing, name))
        except Exception:
            continue
    for cell in (isinstance(thing, types.FunctionType) and thing.__closure__) or ():
        try:
            parts.append(cell.cell_contents)
        except ValueError:
            continue
    if state_of_modules and isinstance(thing, types.FunctionType):
        parts.append(thing.__globals__)
    return parts


# Through objects, closures and modules.


class Objects(Cheat):
    """What hangs on what it is told and shown."""

    def look(self, briefing):
        return search([briefing, self])

    def peek(self, observation):
        return search([observation])


class Bases(Cheat):
    """The memory that its arrays are cut from."""

    def peek(self, observation):
        for thing in (observation, self.briefing):
            for array in vars(thing).values():
                base = array
                while isinstance(getattr(base, "base", None), np.ndarray):
                    base = base.base
                if isinstance(base, np.ndarray) and base.size > array.size:
                    return f"{base.size} numbers behind {array.size}"
        return None


class Closures(Cheat):
    """The functions of what it is handed, their cells and their modules' globals."""

    def peek(self, observation):
        handed = (self.briefing, observation, self.briefing.rng)
        return search([f for h in handed for _, f in inspect.getmembers(type(h))])


class Modules(Cheat):
    """What the modules hold: tables, caches, registries, whoever is running."""

    def peek(self, observation):
        if self.seen or observation.time[0] > 0.0:  # once is enough
            return None
        return search([*sys.modules.values()], state_of_modules=True)


class Threads(Cheat):
    """What other threads were started with."""

    def peek(self, observation):
        return search(threading.enumerate())


class Contexts(Cheat):
    """Variables of the context."""

    def peek(self, observation):
        return search([*contextvars.copy_context().values()])


class Generators(Cheat):
    """The seed of its generator, by trying the seeds that everybody would use."""

    def look(self, briefing):
        state = briefing.rng.bit_generator.state
        for seed in range(200):
            for key in ((), (0,), (1,), (2,)):
                sequence = np.random.SeedSequence(seed, spawn_key=key)
                if np.random.PCG64(sequence).state == state:
                    return f"seed {seed}"
        known = getattr(briefing.rng.bit_generator.seed_seq, "entropy", None)
        return None if known is None else f"seed {known}"


class Scribbles(Cheat):
    """Writes into all that it is handed, to move itself to its goal."""

    def act(self, observation):
        command = super().act(observation)
        for array in (*vars(observation).values(), *vars(self.briefing).values()):
            if isinstance(array, np.ndarray):
                array.setflags(write=True)
                array[...] = 0
        return command


class Builder(Cheat):
    """Moves the walls of its map out of the way."""

    def peek(self, observation):
        for solid in observation.maps[0].solids if observation.maps[0] else ():
            for array in (*solid.loops, solid.capsules):
                array.setflags(write=True)
                array[...] = 99.0
            object.__setattr__(solid, "center", (99.0, 99.0))
            object.__setattr__(solid, "radius", 1e-3)


class Patches(Cheat):
    """Puts a function of its own before one that is handed the world."""

    def look(self, briefing):
        from benchnav.world.simulation import Simulation

        honest = Simulation.step

        def step(simulation, *told):
            self.learn(pillar_in(simulation))
            return honest(simulation, *told)

        Simulation.step = step


class PatchesModules(Cheat):
    """The same for a name of a module that is there in this process."""

    def peek(self, observation):
        driver = sys.modules.get("benchnav.navigation.observe")
        if driver is None or hasattr(driver.sense, "spy"):
            return
        honest = driver.sense

        def sense(simulation, *told):
            self.learn(pillar_in(simulation))
            return honest(simulation, *told)

        sense.spy = True
        driver.sense = sense


class PatchesCode(Cheat):
    """The same by another body for the function that is there."""

    def look(self, briefing):
        from benchnav.world.simulation import Simulation

        def step(self, command, twist):
            import tests.conformance.cheats as cheats

            cheats.STOLEN.append(cheats.pillar_in(self))
            return command

        Simulation.step.__code__ = step.__code__

    def peek(self, observation):
        return STOLEN[0] if STOLEN else None


STOLEN = []


# Through frames and the garbage collector.


class Frames(Cheat):
    """The variables of whoever called it."""

    def peek(self, observation):
        frame = sys._getframe()
        while frame is not None:
            found = search([*frame.f_locals.values()])
            if found:
                return found
            frame = frame.f_back
        return None


class Tracebacks(Cheat):
    """The same by way of an exception."""

    def peek(self, observation):
        try:
            raise KeyError
        except KeyError as error:
            frame = error.__traceback__.tb_frame
        while frame is not None:
            found = search([*frame.f_locals.values()])
            if found:
                return found
            frame = frame.f_back
        return None


class OtherFrames(Cheat):
    """The frames of all threads, seen from another."""

    def peek(self, observation):
        found = []

        def watch():
            for frame in sys._current_frames().values():
                while frame is not None:
                    found.append(search([*frame.f_locals.values()]))
                    frame = frame.f_back

        thread = threading.Thread(target=watch)
        thread.start()
        thread.join()
        return next(filter(None, found), None)


class Profiler(Cheat):
    """A profiler, which is handed the frame of every call."""

    def look(self, briefing):
        def watch(frame, event, argument):
            if self.seen is None and event == "call":
                for value in frame.f_locals.values():
                    self.learn(pillar_in(value))

        sys.setprofile(watch)

    def peek(self, observation):
        if self.seen:
            sys.setprofile(None)


class Collector(Cheat):
    """What the garbage collector looks after."""

    def peek(self, observation):
        return next(filter(None, map(pillar_in, gc.get_objects())), None)


class Referrers(Cheat):
    """Whoever holds what it was handed, and whoever holds them."""

    def peek(self, observation):
        ring = [self.briefing, observation]
        for _ in range(4):
            ring = [r for r in gc.get_referrers(*ring) if not isinstance(r, types.FrameType)]
            found = search(ring[:2000])
            if found:
                return found
        return None


# Through process memory, and what a process inherits.


class MemoryConfig(PluginConfig):
    """A fair clue: half of the answer, and how to tell that the other half is right."""

    x: str = Field(description="the pillar's x, as float.hex")
    proof: str = Field(description="sha256 of the bytes of its y")


class Memory(Cheat):
    """The memory of its process and of whoever started it: the y that follows the known x."""

    Config = MemoryConfig

    def peek(self, observation):
        return next(filter(None, map(self.in_memory, (os.getpid(), os.getppid()))), None)

    def in_memory(self, pid):
        x = struct.pack("<d", float.fromhex(self.config.x))
        try:
            areas = Path(f"/proc/{pid}/maps").read_text().splitlines()
            file = os.open(f"/proc/{pid}/mem", os.O_RDONLY)
        except OSError:
            return None
        with os.fdopen(file, "rb", buffering=0) as memory:
            for area in areas:
                low, high = (int(end, 16) for end in re.split("[- ]", area)[:2])
                if " rw-p " not in area or high - low > 1 << 28:
                    continue
                try:
                    memory.seek(low)
                    data = memory.read(high - low)
                except OSError:
                    continue
                for hit in re.finditer(re.escape(x), data):
                    y = data[hit.end() : hit.end() + 8]
                    if hashlib.sha256(y).hexdigest() == self.config.proof:
                        return f"{float.fromhex(self.config.x)!r} {struct.unpack('<d', y)[0]!r}"
        return None


PTRACE_SEIZE = 0x4206  # which does not stop whom it traces


class Tracer(Memory):
    """The same by tracing whoever started it, as a debugger does."""

    def in_memory(self, pid):
        if pid == os.getpid() or ctypes.CDLL(None).ptrace(PTRACE_SEIZE, pid, 0, 0) != 0:
            return None
        return "traced it"


class Pointers(Cheat):
    """Objects at the addresses that reference counts betray, by ctypes."""

    def peek(self, observation):
        for held in gc.get_referrers(observation):
            thing = ctypes.cast(id(held), ctypes.py_object).value
            if isinstance(thing, types.FrameType):
                found = search([*thing.f_back.f_locals.values()] if thing.f_back else [])
                if found:
                    return found
        return Frames.peek(self, observation)


class Surroundings(Cheat):
    """Arguments, environment, working folder and other processes' command lines."""

    def peek(self, observation):
        text = " ".join([*sys.argv, *os.environ, os.fspath(Path.cwd())])
        for process in Path("/proc").iterdir():
            try:
                text += (process / "cmdline").read_text() if process.name.isdigit() else ""
            except OSError:
                continue
        return "surroundings" if CLUE in text else None


class Descriptors(Cheat):
    """Files that are open in its process, and not for it."""

    def peek(self, observation):
        for file in Path("/proc/self/fd").iterdir():
            with contextlib.suppress(OSError):
                if file.readlink().name == ".lock":  # that of the run folder
                    return "descriptors"
        return None
