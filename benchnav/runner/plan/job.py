"""Jobs: the cells of a suite, each with one scenario, condition and navigator, for all seeds."""

import hashlib
import json
import re
from dataclasses import dataclass, replace
from typing import Any

from benchnav.arena.world import World
from benchnav.generation.build import build, noise_of, sensing_of
from benchnav.generation.undisturbed_world import undisturbed_world
from benchnav.navigation.navigator import Need
from benchnav.navigation.plugin.capabilities import undriven
from benchnav.navigation.plugin.configure import Spec, split
from benchnav.plugins import NAVIGATORS
from benchnav.runner.plan.contestant import NONE, Contestant
from benchnav.runner.rollouts.rollout import Assignment
from benchnav.scenario.condition import EXACT, NOISY, condition
from benchnav.scenario.sampling.sampler import support
from benchnav.scenario.scenario import Scenario
from benchnav.source.parts import places_of
from benchnav.store.runs.manifest import ISOLATED


@dataclass(frozen=True)
class Job:
    """A cell of a suite: one scenario × track × perception × navigator, with all seeds."""

    scenario: Scenario
    split: str
    track: str
    contestant: Contestant
    also: tuple[str, ...] = ()  # other tracks with the same episodes, as no map is used
    perception: str = EXACT

    @property
    def assignment(self) -> Assignment:
        """The navigator, the scenario and the condition."""
        scenario, contestant = self.scenario, self.contestant
        navigator, background = contestant.spec, scenario.driver_specs
        if self.undisturbed:
            navigator, *others = background
            background = tuple(others)
        return Assignment(
            scenario.identity, scenario.hash, self.split, self.track, contestant.label,
            navigator, background, navigator_hash=contestant.hash,
            source_hash=contestant.source_hash, rehearsals=contestant.rehearsal,
            leader=contestant.leader.spec if contestant.leader else None,
            isolated=contestant.mode == ISOLATED,
            noise=noise_of(scenario) if self.perception == NOISY else None,
            undisturbed=self.undisturbed,
        )  # fmt: skip

    @property
    def undisturbed(self) -> bool:
        """Whether its worlds are those without the evaluated agents."""
        return self.contestant == NONE

    def world(self, seed: int) -> World:
        """Draw the world of a seed."""
        drawn = build(self.scenario, self.split, seed)
        return undisturbed_world(drawn) if self.undisturbed else drawn

    @property
    def places(self) -> tuple[str, ...]:
        """The places, module:attribute, of the classes of all its navigators and their parts."""
        others = (place for spec in self.scenario.driver_specs for place in places_of(_full(spec)))
        return (*self.contestant.places, *others)

    @property
    def once(self) -> bool:
        """Whether all tracks of the scenario have the same episodes."""
        return not self.contestant.uses_map and self.track in self.scenario.granted_tracks

    @property
    def condition(self) -> str:
        """The track, and the perception unless it is exact."""
        return condition(self.track, self.perception)

    @property
    def shown(self) -> str:
        """The name of the cell in messages."""
        return f"{self.scenario.identity}, {self.condition}, {self.contestant.label}"

    @property
    def contest(self) -> tuple[str, str, str]:
        """The scenario, the perception, and the navigator's label."""
        return self.scenario.identity, self.perception, self.contestant.label

    @property
    def key(self) -> str:
        """The name of its folder: readable, with a hash of scenario, condition and navigator."""
        a = self.assignment
        noisy = () if a.perception == EXACT else (a.perception,)
        spec = dict(self.contestant.spec)
        text = json.dumps([a.scenario, a.scenario_hash, a.split, a.track, *noisy, a.label, spec])
        parts = (_slug(a.scenario), a.track, *noisy, _slug(a.label))
        return ".".join(parts) + "." + hashlib.sha256(text.encode()).hexdigest()[:10]

    @property
    def reason(self) -> str:
        """The reason why it is n/a; "" if it can run."""
        if self.contestant.missing_extra:
            return self.contestant.missing_extra
        if self.undisturbed:
            return ""
        if self.track not in self.scenario.granted_tracks:
            return f"the scenario has no track {self.track!r}"
        led = self.contestant.leader
        why = self._unfit(self.contestant)
        if why or led is None:
            return why
        why = led.missing_extra or self._unfit(led)
        return f"its leaders' {led.label} {why}" if why else ""

    def _unfit(self, contestant: Contestant) -> str:
        """Return why a navigator cannot use the map, the sensors or the bodies; "" if it can."""
        if Need.MAP in contestant.required and self.track == "unknown":
            return "needs a map"
        if why := undriven(contestant.drives, self._dynamics):
            return why
        return contestant.unfit.get(sensing_of(self.scenario), "")

    @property
    def _dynamics(self) -> frozenset[str]:
        """The names of the dynamics of all evaluated agents."""
        teams = self.scenario.teams
        return frozenset(team.dynamics.type for team in teams if team.evaluated)

    @property
    def effort(self) -> float:
        """The expected relative duration of an episode; the longest tasks start first."""
        agents = sum(support(team.count)[1] for team in self.scenario.teams)
        planning = 4.0 if Need.MAP in self.contestant.required else 1.0
        effort = agents * self.scenario.clock.steps * planning
        if self.contestant.leader is not None:
            led = replace(self, contestant=self.contestant.leader)
            effort += self.contestant.rehearsal * led.effort * self._led / agents
        return effort

    @property
    def _led(self) -> float:
        """The largest number of rehearsing agents: leaders, or one of a team without a leader."""
        counts: dict[str, list[float]] = {}
        for team in self.scenario.teams:
            most = support(team.count)[1]
            share = counts.setdefault(team.name, [0.0])
            share[0] += most if team.role == "leader" else 0.0
        return sum(max(share[0], 1.0) for share in counts.values())


def undisturbed_job(scenario: Scenario, split: str) -> Job:
    """Return the cell of a scenario's worlds without evaluated agents.

    It is of the track known, on which background navigators always are.
    """
    return Job(scenario, split, "known", NONE)


def _full(spec: Spec) -> dict[str, Any]:
    name, parameters = split(NAVIGATORS, spec)
    return {"type": name, **parameters}


def _slug(text: str) -> str:
    return re.sub(r"[^A-Za-z0-9@_-]+", "-", text)[:60]
