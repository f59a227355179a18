"""The maps that a navigator made: equal to those during the episode, or left out with a reason."""

from dataclasses import replace

import numpy as np
import pytest

import benchnav
from benchnav.arena.solid import Kind, Solid
from benchnav.navigation import AgentNavigator
from benchnav.navigation.map import Map
from benchnav.verify.own_map import map_changes, own_maps
from benchnav.viewer.replay.scene import scene
from tests.viewer.browser import in_browser, needs_chromium

ALL = np.arange(4)


class Breadcrumbs(AgentNavigator):
    """Goes straight, and maps a disc where it was; what it maps is kept for the test."""

    seen = {}  # noqa: RUF012 - the test reads it

    def reset_agent(self, briefing, row, agent):
        return {"map": Map((0, 0, 9, 9), ())}

    def act_agent(self, view, briefing):
        x, y = view.position.tolist()
        dot = Solid(Kind.STATIC, center=(x, y), radius=0.1)
        view.state["map"] = Map((0, 0, 9, 9), (*view.state["map"].solids[-3:], dot))
        self.seen.setdefault((view.agent, round(view.time, 6)), view.state["map"])
        return view.goal - view.position

    def own_map(self, row, agent):
        return self._states[row][agent]["map"]


@pytest.fixture(scope="module")
def world():
    return benchnav.load_scenario("leaders/dynamic").world(seed=7)


@pytest.fixture(scope="module")
def mapped():
    drawn = benchnav.load_scenario("trap/u").world(seed=0)
    return benchnav.simulate(drawn, "mapping+visibility+orca", track="unknown", salt="00")


def test_maps_are_those_of_the_episode(world):
    Breadcrumbs.seen.clear()
    episode = benchnav.simulate(world, Breadcrumbs)
    found = own_maps(episode.origin, episode.record, ALL[1:])
    assert found.agents.tolist() == [1, 2, 3]
    assert all(len(maps) > 2 for maps in found.maps)
    table, changes = map_changes(found)
    for agent, maps, own in zip(found.agents, found.maps, changes, strict=True):
        held = set()
        for (state, shown), (when, added, removed) in zip(maps, own, strict=True):
            assert when == state
            during = Breadcrumbs.seen[agent, round(state * episode.record.world.clock.dt, 6)]
            assert np.array_equal(during.capsules, shown.capsules)
            held = (held - set(removed)) | set(added)
            assert np.allclose(sorted(table[sorted(held)].tolist()),
                               sorted(during.capsules.tolist()), atol=0.0006)  # fmt: skip
        gaps = np.diff([state for state, _ in maps])[:-1]
        assert (gaps * episode.record.world.clock.dt >= 1.0 - 1e-9).all()


def test_a_mapped_edge_lies_on_a_wall(mapped):
    """In the track unknown all that is mapped was sensed."""
    found = own_maps(mapped.origin, mapped.record, ALL)
    walls = np.vstack([solid.capsules for solid in mapped.record.world.solids])
    last = found.maps[0][-1][1].capsules
    assert len(last) > 4
    for x0, y0, x1, y1, _ in last:
        away = np.array([0.5 * (x0 + x1), 0.5 * (y0 + y1)]) - walls[:, :2]
        way = walls[:, 2:4] - walls[:, :2]
        along = ((away * way).sum(1) / (way**2).sum(1)).clip(0, 1)
        assert np.linalg.norm(away - along[:, None] * way, axis=1).min() < 1e-6


def test_where_there_is_no_map_there_is_none(world):
    for name in ("orca", "visibility+orca"):
        episode = benchnav.simulate(world, name)
        assert own_maps(episode.origin, episode.record, ALL) is None
    content = scene(episode.record, ALL, episode.origin)
    assert content["own_map"] is None


def test_other_commands_show_no_map(world, mapped):
    other = benchnav.simulate(world, "straight-line")
    why = own_maps(mapped.origin, other.record, ALL)
    assert why == "its commands differ from the stored ones at t = 0.0 s"
    assert scene(other.record, ALL, mapped.origin)["own_map"] == {"reason": why}
    assert own_maps(lambda: "no", other.record, ALL) == "no"


def test_an_exception_is_a_reason(world):
    class Breaks(Breadcrumbs):
        def own_map(self, row, agent):
            raise KeyError("lost")

    episode = benchnav.simulate(world, Breaks)
    assert "KeyError" in own_maps(episode.origin, episode.record, ALL)


def test_a_stored_run_shows_its_maps(tmp_path):
    by_module = {"type": "tests.viewer.test_own_map:Breadcrumbs", "label": "crumbs"}
    suite = {
        "name": "maps", "scenarios": ["leaders/static"], "tracks": ["unknown"], "seeds": 1,
        "navigators": ["mapping+visibility+orca", by_module],
    }  # fmt: skip
    run = benchnav.run(suite, out=tmp_path / "run", workers=0, quiet=True)
    for episode in run.episodes():
        found = own_maps(episode.origin, episode.record, ALL[:1])
        assert len(found.maps[0]) > 1
    pack = benchnav.open_run(run.pack(tmp_path / "a.bnrun", quiet=True))
    mapping, by_module = pack.episodes()
    assert len(own_maps(mapping.origin, mapping.record, ALL[:1]).maps[0]) > 1
    assert "packs are not trusted" in own_maps(by_module.origin, by_module.record, ALL)


class Rehearsed(Breadcrumbs):
    """Aims at the places where its leaders were in the rehearsal, so that it needs them."""

    rehearsal = 1
    leader = "straight-line"

    def act_agent(self, view, briefing):
        (way,) = [r.position[-1].mean(axis=0) for r in briefing.rehearsals]
        return super().act_agent(view, briefing) + 0.1 * way


def test_an_episode_after_rehearsals_shows_its_maps(tmp_path):
    spec = {"type": "tests.viewer.test_own_map:Rehearsed", "label": "rehearsed"}
    suite = {"name": "maps", "scenarios": ["groups/diagonal"], "seeds": 1, "navigators": [spec]}
    run = benchnav.run(suite, out=tmp_path / "run", workers=0, quiet=True)
    (episode, *_) = run.episodes()
    assert (episode.record.rehearsals, episode.failure) == (1, "")
    assert len(own_maps(episode.origin, episode.record, ALL).maps[0]) > 1
    made = episode.origin()
    why = own_maps(lambda: replace(made, rehearsals=()), episode.record, ALL)
    assert why == "not all of its rehearsals were run"


@needs_chromium
@pytest.mark.slow
def test_the_page_draws_the_map_in_step_with_time(mapped, tmp_path):
    page = mapped.replay().html
    assert len(page) <= 150_000
    found = own_maps(mapped.origin, mapped.record, ALL)
    agent, (state, _) = int(found.agents[2]), found.maps[2][6]
    time = state * mapped.record.world.clock.dt
    script = (
        f"const agent = {agent}, time = {time}, state = {state};"
        + """
      await until(() => document.documentElement.dataset.ready === "true");
      const view = replay.views[0], own = view.scene.own_map, n = own.agents.indexOf(agent);
      replay.select(view, agent);
      replay.seek(time);
      const last = own.changes[n].findLastIndex(([at]) => at <= state);
      const painted = () => {
        const { width, height } = view.canvas;
        return new Uint32Array(view.context.getImageData(0, 0, width, height).data.buffer);
      };
      const labels = [...document.querySelectorAll(".toggles label")];
      const box = labels.find((label) => label.textContent.includes("own map")).firstChild;
      const drawn = () => {  // how many pixels the map changes
        const shown = painted();
        box.click();
        const hidden = painted();
        box.click();
        return shown.filter((value, i) => value !== hidden[i]).length;
      };
      const then = drawn();
      replay.seek(0);
      return { n, last, keys: [...view.own.keys()], then, start: drawn() };
    """
    )
    result = in_browser(page, script, tmp_path)
    assert result["last"] == 6
    assert f"{result['n']} 6" in result["keys"]
    assert result["then"] > 300
    assert result["start"] < result["then"]  # little was sensed by then


@needs_chromium
@pytest.mark.slow
def test_the_page_gives_the_reason(mapped, world, tmp_path):
    from benchnav.viewer.replay.page import replay_page

    other = benchnav.simulate(world, "straight-line")
    page = replay_page([scene(other.record, ALL, mapped.origin)])
    text = in_browser(page, """
      await until(() => document.documentElement.dataset.ready === "true");
      return document.querySelector(".side").textContent;
    """, tmp_path)  # fmt: skip
    assert "is not shown: its commands differ from the stored ones at t = 0.0 s." in text


def test_maps_of_a_noisy_episode():
    drawn = benchnav.load_scenario("trap/u").world(seed=0)
    episode = benchnav.simulate(
        drawn, "mapping+visibility+orca", track="unknown", salt="00", perception="noisy"
    )
    assert len(own_maps(episode.origin, episode.record, ALL[:1]).maps[0]) > 1
