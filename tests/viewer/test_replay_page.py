"""The page of a replay in a real browser: it loads, plays, is scrubbed and jumps."""

from itertools import combinations

import numpy as np
import pytest

import benchnav
from benchnav.testing.zoo import zoo
from benchnav.viewer.replay.page import replay_page
from benchnav.viewer.replay.scene import interesting, scene
from tests.viewer.browser import DESKTOP, PHONE, in_browser, needs_chromium
from tests.worlds import agents, world

pytestmark = [needs_chromium, pytest.mark.slow]
READY = 'await until(() => document.documentElement.dataset.ready === "true");'


@pytest.fixture(scope="module")
def page():
    """Two navigators side by side."""
    drawn = benchnav.load_scenario("leaders/dynamic").world(seed=7)
    both = [benchnav.simulate(drawn, name, track="known") for name in ("orca", "straight-line")]
    return replay_page([scene(episode.record, interesting(episode.record)) for episode in both])


def test_it_plays_is_scrubbed_and_jumps(page, tmp_path):
    result = in_browser(page, READY + """
      const out = {};
      const buttons = [...document.querySelectorAll("button")];
      const button = (text) => buttons.find((b) => b.textContent === text);
      button("Play").click();
      await until(() => replay.time > 0.3);
      button("Pause").click();
      const stopped = replay.time;
      await wait(0.2);
      out.stays = replay.time === stopped;
      const slider = document.querySelector("input[type=range]");
      slider.value = "10"; slider.dispatchEvent(new Event("input"));
      out.scrubbed = replay.time;
      button("+1").click();
      out.stepped = replay.time;
      replay.seek(0);
      button("Next").click();
      out.jumped = replay.time === replay.events()[0].event.time;
      out.events = document.querySelectorAll(".side ol li").length === replay.events().length;
      const painted = replay.views[0].context.getImageData(0, 0, 400, 400).data;
      out.colours = new Set(new Uint32Array(painted.buffer)).size;
      replay.select(replay.views[1], 2);
      out.title = document.querySelector(".side h2").textContent;
      return out;
    """, tmp_path)  # fmt: skip
    assert result["stays"]
    assert result["scrubbed"] == 10
    assert result["stepped"] == pytest.approx(10.2)
    assert result["jumped"]
    assert result["events"]
    assert result["colours"] > 5
    assert result["title"] == "Agent 2 of straight-line"


def test_it_shows_how_attempts_end(page, tmp_path):
    linked = page.replace('data-back=""', 'data-back="../failures.html"')
    result = in_browser(linked, READY + """
      const view = replay.views[1], { agents } = view.scene, out = { agents };
      const lost = agents.success.indexOf(false);
      replay.select(view, lost);
      out.lost = lost;
      out.result = document.querySelector(".side .result").textContent;
      out.title = document.querySelector(".chart span").textContent;
      out.lengths = replay.charts.map((chart) => chart.values.length);
      out.start = view.caption.textContent;
      replay.seek(replay.duration);
      out.now = document.querySelector(".chart output").textContent;
      out.end = view.caption.textContent;
      out.legend = document.querySelectorAll(".legend li").length;
      out.back = document.querySelector(".back").getAttribute("href");
      const lines = view.context.lineTo.bind(view.context);
      const points = () => {
        let count = 0;
        view.context.lineTo = (x, y) => { count += 1; lines(x, y); };
        view.drawTrails(view.context, 0.01, view.times - 1);
        return count;
      };
      out.short = points();
      replay.show.whole = true;
      out.whole = points();
      return out;
    """, tmp_path)  # fmt: skip
    last, success = result["agents"]["last"], result["agents"]["success"]
    lost, arrived = result["lost"], sum(success)
    assert result["result"] == f"No success: {result['agents']['end'][lost]}."
    assert " at " in result["result"]
    assert result["title"].startswith("speed, ")
    assert result["lengths"] == [last[lost], last[lost], last[lost] + 1, last[lost] + 1]
    assert result["now"] == "ended"
    assert f"0 of 4 arrived now, {arrived} at the end" in result["start"]
    assert f"{arrived} of 4 arrived" in result["end"]
    assert "at the end" not in result["end"]
    assert result["legend"] == 4
    assert result["back"] == "../failures.html"
    assert result["whole"] == sum(last)  # a line for each step of every attempt
    assert 0 < result["short"] <= 4 * 31  # the last 6 s, also of agents that vanished


@pytest.mark.parametrize("size", [DESKTOP, PHONE])
def test_nothing_sticks_out(page, tmp_path, size):
    result = in_browser(page, READY + """
      const narrow = [...document.querySelectorAll("button, canvas, select, input")].filter((e) => {
        const box = e.getBoundingClientRect();
        return box.width && (box.left < 0 || box.right > innerWidth + 0.5);
      }).map((e) => e.outerHTML);
      return { wide: document.documentElement.scrollWidth - innerWidth, narrow };
    """, tmp_path, size)  # fmt: skip
    assert result["wide"] <= 0
    assert result["narrow"] == []


@pytest.mark.parametrize("size", [DESKTOP, PHONE])
def test_parts_stand_where_they_belong(page, tmp_path, size):
    """By the boxes of elements: fonts differ between machines, and with them every pixel."""
    result = in_browser(page, READY + """
      const root = document.documentElement, box = (element) => {
        const { left, top, right, bottom } = element.getBoundingClientRect();
        return { left, top: top + scrollY, right, bottom: bottom + scrollY };
      };
      const named = Object.fromEntries([".views", ".side", ".bar"].map((name) =>
        [name.slice(1), box(document.querySelector(name))]));
      return {
        ...named, canvases: [...document.querySelectorAll(".view canvas")].map(box),
        buttons: [...document.querySelectorAll(".bar button")].map(box),
        captions: [...document.querySelectorAll(".caption")].map(box),
        page: [root.clientWidth, innerHeight, root.scrollHeight],
        charts: [...document.querySelectorAll(".chart canvas")].map(box),
        track: box(document.querySelector(".track")),
      };
    """, tmp_path, size)  # fmt: skip
    views, side, bar = (result[name] for name in ("views", "side", "bar"))
    wide, high, long = result["page"]
    first, second = result["canvases"]
    assert all(button["bottom"] - button["top"] >= 32 for button in result["buttons"])
    assert all(inside(button, bar) for button in (*result["buttons"], result["track"]))
    assert all(inside(chart, side) for chart in result["charts"])
    assert all(inside(c, v) for c, v in zip(result["captions"], (first, second), strict=True))
    assert not any(overlap(*pair) for pair in combinations((first, second, side), 2))
    assert (views["left"], bar["left"]) == (0, 0)
    assert bar["right"] == pytest.approx(wide, abs=1)
    if size == DESKTOP:  # beside each other, the bar below, and nothing to scroll
        assert long <= high
        assert first["top"] == second["top"]
        assert views["right"] == pytest.approx(side["left"], abs=1)
        assert bar["top"] == pytest.approx(views["bottom"], abs=1)
        assert bar["bottom"] == pytest.approx(high, abs=1)
        assert first["bottom"] - first["top"] > 0.8 * high
    else:  # one below the other, with the bar always in sight
        assert second["top"] >= first["bottom"]
        assert side["top"] >= views["bottom"]
        assert all(part["right"] == pytest.approx(wide, abs=1) for part in (first, second, side))
        assert all(c["bottom"] - c["top"] >= 0.4 * wide for c in (first, second))
        assert bar["bottom"] <= high + 1


def inside(part, whole, room=1.0):
    return all(
        sign * (part[side] - whole[side]) >= -room
        for side, sign in (("left", 1), ("top", 1), ("right", -1), ("bottom", -1))
    )


def overlap(one, other):
    return (
        min(one["right"], other["right"]) - max(one["left"], other["left"]) > 1
        and min(one["bottom"], other["bottom"]) - max(one["top"], other["top"]) > 1
    )


def test_positions_are_those_of_the_episode(tmp_path):
    drawn = benchnav.load_scenario("trap/u").world(seed=0)
    record = benchnav.simulate(drawn, "straight-line").record
    result = in_browser(replay_page([scene(record, interesting(record))]), READY + """
      const view = replay.views[0];
      return [0, 1, 2, 3].map((a) => view.at(a, 5).concat(view.value(view.scene.heading, a, 5)));
    """, tmp_path)  # fmt: skip
    expected = np.column_stack([record.position[5], record.heading[5]])
    assert np.allclose(result, expected, atol=0.001)


@pytest.mark.long
def test_a_crowd_of_a_thousand_is_small_and_plays(tmp_path):
    """1,000 agents and 600 steps: at most 8 MB, and every frame is drawn."""
    rng = np.random.default_rng(0)
    start = rng.uniform(1, 99, (1000, 2))
    crew = agents(start, 100.0 - start, radius=0.3, speed=1.4, team=rng.integers(0, 4, 1000))
    drawn = world(crew, side=100.0, steps=600)
    from benchnav.api.records.episode import Episode
    from tests.viewer.made_episode import straight_episode

    record = straight_episode(drawn, 600)
    page = Episode(record).replay().html
    assert len(page) <= 8_000_000
    frames = in_browser(page, READY + """
      let frames = 0;
      const draw = replay.draw.bind(replay);
      replay.draw = () => { frames += 1; draw(); };
      replay.speed = 8;
      const began = performance.now();
      replay.play();
      await wait(2);
      replay.pause();
      return { rate: frames / ((performance.now() - began) / 1000) };
    """, tmp_path)  # fmt: skip
    print("frames a second:", frames["rate"])
    assert frames["rate"] > 2


def test_an_agent_is_drawn_and_clicked_from_its_entry_on(tmp_path):
    episode = zoo()["late"]
    page = replay_page([scene(episode, interesting(episode))])
    result = in_browser(page, READY + """
      const view = replay.views[0], out = {};
      const box = view.canvas.getBoundingClientRect(), { scale, x, y } = view.frame();
      const at = (k) => [x + scale * view.at(1, k)[0], y - scale * view.at(1, k)[1]];
      const ratio = window.devicePixelRatio || 1;
      const pixel = ([px, py]) =>
        [...view.context.getImageData(px * ratio, py * ratio, 1, 1).data].join(",");
      for (const time of [1.0, 5.0]) {
        replay.seek(time);
        const [px, py] = at(time / view.scene.dt);
        replay.select(view, -1);
        await wait(0.1);
        const painted = pixel([px, py]);
        view.click({ offsetX: px, offsetY: py, clientX: box.left + px, clientY: box.top + py });
        out[time] = [painted, document.querySelector(".side h2")?.textContent ?? ""];
      }
      return out;
    """, tmp_path)  # fmt: skip
    (before, none), (after, chosen) = result["1"], result["5"]
    assert before != after
    assert none != "Agent 1"
    assert chosen == "Agent 1"
