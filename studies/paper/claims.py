"""The claims of the paper, each with a verdict from our measurements."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from . import cast
from .curves import EARLY, WITH, WITHOUT, budget, early_success, gains, last_success
from .encounters import SPEED, TURN, Behaviour
from .evidence import Difference, Evidence, Value
from .groups import cell as among_groups
from .markdown import table
from .table_2 import commands

CONFIRMED, PARTLY, NOT, CONTRADICTED = "confirmed", "in part", "not confirmed", "**contradicted**"
SAFE = 0.01  # hits per agent up to which movers are called avoided
GOOD = 0.95  # least success that counts as good


@dataclass(frozen=True)
class Material:
    """The measurements that a claim is compared with."""

    evidence: Evidence
    behaviours: dict[str, Behaviour]


Finding = tuple[str, str]  # verdict, the figure
Claim = tuple[str, Callable[[Material], Finding]]


def section(material: Material) -> Iterator[str]:
    """Yield the lines of the section."""
    yield "## The paper's claims"
    yield ""
    yield (
        "A rule computes each verdict from the run. *Confirmed* means that the claim holds; if it"
        " compares, the paired 95 % interval must exclude zero. Success is good"
        f" from {100 * GOOD:.0f} % on; movers (dynamic obstacles) are avoided up to"
        f" {100 * SAFE:.0f} hit per 100 agents."
        " *Contradicted* means that the opposite holds; *not confirmed* means neither."
        " *In part* means that only a part of the claim holds."
    )
    yield ""
    found = ((text, *judge(material)) for text, judge in CLAIMS)
    yield from table(["the paper says", "we find", "measured"], found)


def _percent(m: Material, metric: str, cell: tuple[str, str, str]) -> str:
    return m.evidence.value(metric, cell).text(100) + " %"


def _compared(change: Difference, wanted: int) -> str:
    """Return the verdict on a difference; ``wanted`` is its sign according to the claim."""
    if not change.sure:
        return NOT
    return CONFIRMED if wanted * change.mean > 0 else CONTRADICTED


def _moves(m: Material) -> Finding:
    before, after = (cast.STATIC, "unknown", cast.PAPER), (cast.MOVED, "unknown", cast.PAPER)
    change = m.evidence.difference("success", after, before)
    good = m.evidence.value("success", after).mean >= GOOD
    verdict = CONTRADICTED if change.sure and change.mean < 0 else CONFIRMED if good else PARTLY
    return verdict, (
        f"success {_percent(m, 'success', before)} before, {_percent(m, 'success', after)} after"
    )


def _regenerates(m: Material) -> Finding:
    old, new = ((cast.MOVED, track, cast.PLANNER) for track in ("stale", "known"))
    change = m.evidence.difference("success", old, new)
    return _compared(change, -1), (
        f"`{cast.PLANNER}` on the old map {_percent(m, 'success', old)}, on a new one"
        f" {_percent(m, 'success', new)}, paired difference {change.text(100)}"
    )


def _needs_map(m: Material) -> Finding:
    mapper, blind = ((cast.STATIC, "unknown", navigator) for navigator in (cast.MAPPER, cast.BLIND))
    known = (cast.STATIC, "known", cast.PLANNER)
    gain = m.evidence.difference("arrival", mapper, blind)
    return PARTLY if gain.sure and gain.mean > 0 else CONFIRMED, (
        f"`{cast.PLANNER}` is n/a without a map, but one that maps what its own rays see,"
        f" `{cast.MAPPER}`, arrives in {_percent(m, 'arrival', mapper)} of `{cast.STATIC}`, against"
        f" {_percent(m, 'arrival', known)} with a map and {_percent(m, 'arrival', blind)} without"
        " plan"
    )


def _planning_and_movers(m: Material) -> Finding:
    planned = (cast.DYNAMIC, "known", cast.PLANNER)
    blind = (cast.DYNAMIC, "unknown", cast.BLIND)
    hits = m.evidence.value("collisions_dynamic", planned)
    return CONFIRMED if hits.low > SAFE else NOT, (
        f"`{cast.PLANNER}` is hit by movers {hits.text(100)} times per 100 agents,"
        f" `{cast.BLIND}` {m.evidence.value('collisions_dynamic', blind).text(100)}"
    )


def _local_and_movers(m: Material) -> Finding:
    mine, blind = ((cast.DYNAMIC, "unknown", navigator) for navigator in (cast.LOCAL, cast.BLIND))
    hits = m.evidence.value("collisions_dynamic", mine)
    fewer = m.evidence.difference("collisions_dynamic", mine, blind)
    return avoided(hits, fewer), (
        f"`{cast.LOCAL}`: {hits.text(100)} hits per 100 agents, {fewer.text(100)} against going"
        " straight"
    )


def _paper_and_movers(m: Material) -> Finding:
    mine, other = ((cast.DYNAMIC, "unknown", navigator) for navigator in (cast.PAPER, cast.LOCAL))
    blind = (cast.DYNAMIC, "unknown", cast.BLIND)
    hits = m.evidence.value("collisions_dynamic", mine)
    fewer = m.evidence.difference("collisions_dynamic", mine, blind)
    better = m.evidence.difference("success", mine, other)
    return avoided(hits, fewer), (
        f"`{cast.PAPER}`: {hits.text(100)} hits per 100 agents, {fewer.text(100)} against going"
        " straight;"
        f" success {_percent(m, 'success', mine)}, {better.text(100)} against `{cast.LOCAL}`;"
        f" `{cast.PLUS}`:"
        f" {m.evidence.value('collisions_dynamic', (cast.DYNAMIC, 'unknown', cast.PLUS)).text(100)}"
    )


def avoided(hits: Value, fewer: Difference) -> str:
    """Judge by the hits of an agent, and by their difference from going straight."""
    if hits.high <= SAFE:
        return CONFIRMED
    if fewer.sure and fewer.mean < 0:
        return PARTLY
    return CONTRADICTED if hits.low > SAFE else NOT


def _reacts(m: Material) -> Finding:
    b = m.behaviours[cast.PAPER]
    reacted = [x.sped > SPEED or x.turned > TURN for x in b.encounters]
    share = sum(reacted) / max(len(reacted), 1)
    more = b.turning[1] > b.turning[0] and b.speed[1] > b.speed[0]
    return CONFIRMED if share > 0.5 and more else PARTLY if share > 0.5 else NOT, (
        f"in {100 * share:.0f} % of {len(reacted):,} encounters it speeds up or turns; under an"
        " alarm it"
        f" turns at {b.turning[1]:.2f} rad/s instead of {b.turning[0]:.2f} and goes"
        f" {b.speed[1]:.2f} m/s instead of {b.speed[0]:.2f}"
    )


def _any_goal(m: Material) -> Finding:
    cell = (cast.STATIC, "unknown", cast.PAPER)
    good = m.evidence.value("success", cell).mean >= GOOD
    return CONFIRMED if good else NOT, (
        f"goals are random in `{cast.STATIC}`: success {_percent(m, 'success', cell)}, paths"
        f" {m.evidence.value('spl', cell).text(1, 3)} by SPL"
    )


def _reaches(m: Material) -> Finding:
    ends = {
        navigator: [
            m.evidence.value("arrival", (at, "unknown", navigator)) for at in (cast.TRAP, cast.MAZE)
        ]
        for navigator in (cast.PAPER, cast.MAPPING_BOTH, cast.HYBRID)
    }
    verdict = CONFIRMED if min(v.mean for v in ends[cast.PAPER]) >= GOOD else CONTRADICTED
    return verdict, f"arrival in `{cast.TRAP}` and `{cast.MAZE}`: " + "; ".join(
        f"`{navigator}` {trap.text(100)} % and {maze.text(100)} %"
        for navigator, (trap, maze) in ends.items()
    )


def _local_stuck(m: Material) -> Finding:
    cells = [(scenario, "unknown", cast.LOCAL) for scenario in (cast.TRAP, cast.MAZE)]
    values = [m.evidence.value("arrival", cell) for cell in cells]
    return CONFIRMED if max(v.high for v in values) < GOOD else NOT, (
        f"`{cast.LOCAL}` arrives in {values[0].text(100)} % and {values[1].text(100)} %"
    )


def _lstm(m: Material) -> Finding:
    budgets = (
        (early_success(WITH), early_success(WITHOUT)),
        (last_success(WITH), last_success(WITHOUT)),
    )
    if all(min(with_) > max(without) for with_, without in budgets):
        verdict = CONFIRMED
    else:
        worse = all(max(with_) < min(without) for with_, without in budgets)
        verdict = CONTRADICTED if worse else NOT
    early, late = (
        f"with {_percents(with_)} %, without {_percents(without)} %" for with_, without in budgets
    )
    return verdict, (
        f"success by seed after {EARLY / 1e6:.0f} million decisions: {early}; after"
        f" {budget(WITH) / 1e6:.0f} million: {late}"
    )


def _percents(shares: list[float]) -> str:
    return ", ".join(f"{100 * x:.1f}" for x in shares)


def _curve(m: Material) -> Finding:
    first, second, third = gains()
    steady = first > second > third and abs(third) < 0.2 * first
    return CONFIRMED if steady else NOT, (
        f"reward rises by {first:.2f}, {second:.2f}, {third:.2f} in the thirds of the first stage"
    )


def _many_goals(m: Material) -> Finding:
    cell = (cast.STATIC, "unknown", cast.PAPER)
    return _any_goal(m)[0], (
        "four leaders with goals of their own learned together, one network for all:"
        f" {_percent(m, 'success', cell)}"
    )


def _discrete(m: Material) -> Finding:
    table_, paper = (
        (cast.STATIC, "unknown", navigator) for navigator in (cast.TABULAR, cast.PAPER)
    )
    few, n = commands(m.evidence, table_)
    many, k = commands(m.evidence, paper)
    return CONFIRMED if few < 100 < many else NOT, (
        f"`{cast.TABULAR}` gave {few} different commands in {n:,} decisions, `{cast.PAPER}`"
        f" {many:,} in"
        f" {k:,}"
    )


def _jagged(m: Material) -> Finding:
    paper = (cast.STATIC, "unknown", cast.PAPER)
    tables = [(cast.STATIC, "unknown", cast.TABULAR), (cast.STATIC, "known", cast.GRID)]
    changes = [m.evidence.difference("turning", paper, cell) for cell in tables]
    sensed, cells = (m.evidence.value("turning", cell).text(1, 2) for cell in tables)
    return _together(_compared(change, -1) for change in changes), (
        f"turning {m.evidence.value('turning', paper).text(1, 2)} rad/m; `{cast.GRID}`, over the"
        f" cells of a known arena, {cells}; `{cast.TABULAR}`, over what is sensed, {sensed}"
    )


def _together(verdicts: Iterable[str]) -> str:
    """Return the common verdict; "in part" if verdicts differ."""
    found = set(verdicts)
    return found.pop() if len(found) == 1 else PARTLY


def _guided(m: Material, metric: str) -> Difference:
    """Return the difference between followers that are guided and followers that plan."""
    cells = (among_groups(navigator) for navigator in (cast.GUIDED, cast.BOTH))
    return m.evidence.difference(metric, *cells, "follower")


def _congestion(m: Material) -> Finding:
    density, jam = (_guided(m, metric) for metric in ("density_mean", "jam"))
    return _together(_compared(change, -1) for change in (density, jam)), (
        f"against `{cast.BOTH}`, density at the centre {density.text(1, 3)} /m², time in a jam"
        f" {jam.text(100)} points"
    )


def _flocks(m: Material) -> Finding:
    cohesion, splits, order = (_guided(m, x) for x in ("cohesion", "splits", "polarisation"))
    wanted = ((cohesion, -1), (splits, -1), (order, 1))
    return _together(_compared(change, sign) for change, sign in wanted), (
        f"against `{cast.BOTH}`, cohesion {cohesion.text(1, 2)} (less is closer), parts of a group"
        f" {splits.text(1, 2)}, polarisation {order.text(1, 3)}"
    )


def _groups_arrive(m: Material) -> Finding:
    arrival = m.evidence.value("arrival", among_groups(cast.GUIDED), "follower")
    success = m.evidence.value("success", among_groups(cast.GUIDED), "follower")
    good = success.mean >= GOOD
    return CONFIRMED if good else PARTLY if arrival.mean >= GOOD else NOT, (
        f"{arrival.text(100)} % of the followers arrive, {success.text(100)} % without a collision,"
        f" {_guided(m, 'success').text(100)} points against `{cast.BOTH}`"
    )


CLAIMS: tuple[Claim, ...] = (
    ("Agents avoid static obstacles in an unknown environment, also when these move, without"
     " training again (contribution 1, Fig. 6).", _moves),
    ("Global planning must generate its graph again when obstacles move.", _regenerates),
    ("Global planning needs a known environment (Table 2).", _needs_map),
    ("Global planning does not avoid movers (Table 2).", _planning_and_movers),
    ("Local avoidance avoids movers (Table 2).", _local_and_movers),
    ("Local avoidance may get stuck and not find the goal (Table 2).", _local_stuck),
    ("Predicting collisions, agents avoid movers (contribution 2, Table 2).", _paper_and_movers),
    ("They speed up or change direction to do so (Fig. 8).", _reacts),
    ("Agents reach any specified goal on a collision-free path (contribution 3).", _any_goal),
    ("They reach the goal, where local avoidance gets stuck (Table 2).", _reaches),
    ("LSTM speeds up learning (contribution 4, Fig. 10).", _lstm),
    ("Reward rises fast, then slowly, then is steady (Fig. 9).", _curve),
    ("Agents with different goals can be trained together (contribution 5).", _many_goals),
    ("Tabular reinforcement learning acts in a discrete space (Table 2).", _discrete),
    ("Its paths are jagged, those of a continuous policy smoother.", _jagged),
    ("Guided groups do not congest at the centre, unlike navmesh + RVO (Figs. 12, 13).",
     _congestion),
    ("Guided groups flock, unlike navmesh + RVO (Figs. 12, 13).", _flocks),
    ("All four groups reach their goals without collisions (Fig. 12).", _groups_arrive),
)  # fmt: skip
