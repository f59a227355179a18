"""Generate docs/metrics.md, the page of all metrics of benchnav, from the registry."""

import inspect
import math
from importlib import import_module

from benchnav.metrics.measure import load_metric
from benchnav.metrics.metric import Metric
from benchnav.plugins import METRICS

SECTIONS = (
    "success", "safety", "efficiency", "smoothness", "congestion", "groups", "following",
    "people", "disturbance", "compute",
)  # fmt: skip
HEAD = '''# Metrics

Generated from the registry by `python -m benchnav.metrics.page > docs/metrics.md`; a test
compares the two.

A metric is a pure function of an episode. (A,) denotes one value per agent. Values are averaged
over the evaluated agents of a role for which they are defined, leaders and followers apart, then
over seeds. An *attempt* is the time in which an agent is on its way. A contact is *charged* to an
agent on its way; the rule `charge` decides for an agent that stays after its attempt.
An undefined value is NaN, never a perfect score. Every agent's trajectory is cut at its
arrival, its end or its navigator's failure. A metric that is defined only for arrivals shows
the number of its episodes, and never ranks. A metric without a direction does not rank.
A value that accumulates over an attempt does not rank, because an agent that crashes has less
time to hit or to be near anything: `check_metric` tests that no ranking metric improves by an
early end. (`contact_time` is undefined if a contact ends the attempt.) Timings are marked,
because others cannot verify them.

The value of every metric stays the same, except for rounding, if the world is moved or turned
or its agents are reordered, and within 5 % if the same smooth motion is recorded at dt, dt/2
and dt/5. `benchnav.testing.check_metric.check_metric` checks the same for metrics of plugins.

The decorator `metric` converts a function into a metric, and `check_metric` checks it:

```python
import numpy as np

from benchnav.metrics.metric import metric
from benchnav.testing.check_metric import check_metric


@metric(title="Arrived in the first 10 s", unit="", better="higher", low=0.0, high=1.0)
def early(episode):
    """(A,) 1 for agents that arrive within 10 s."""
    return (np.nan_to_num(episode.arrival, nan=np.inf) <= 10.0).astype(float)


check_metric(early)
```

A Python package registers each of its metrics by an entry point of the group `benchnav.metrics`:
`early = "my_package.metrics:early"`. In a script, `benchnav.register_metric("early")(early)`
registers it in this process.

| metric | title | unit | better | range | value of | reference |
| --- | --- | --- | --- | --- | --- | --- |
'''


def page() -> str:
    """Return the Markdown page: one table of all shipped metrics, then their definitions."""
    shipped: dict[str, list[Metric]] = {section: [] for section in SECTIONS}
    for name in METRICS.names():
        module, _, _ = METRICS.source(name).value.partition(":")
        section = module.removeprefix("benchnav.metrics.")
        if section in shipped:
            shipped[section].append(load_metric(name))
    rows = [_row(metric) for section in SECTIONS for metric in shipped[section]]
    parts = [_definitions(section, shipped[section]) for section in SECTIONS]
    return HEAD + "\n".join(rows) + "\n\n" + "\n".join(parts)


def _row(metric: Metric) -> str:
    of = "group" if metric.scope == "group" else "agent"
    marks = [
        mark
        for mark, holds in [
            ("arrivals only", metric.conditional), ("not verifiable", not metric.verifiable),
        ]
        if holds
    ]  # fmt: skip
    cells = [
        f"`{metric.name}`", metric.title, metric.unit or "–", metric.better or "–",
        f"{_bound(metric.low, '[')}, {_bound(metric.high, ']')}", ", ".join([of, *marks]),
        metric.reference,
    ]  # fmt: skip
    return f"| {' | '.join(cells)} |"


def _bound(value: float, bracket: str) -> str:
    if math.isinf(value):
        return "(−∞" if value < 0 else "∞)"
    return f"[{value:g}" if bracket == "[" else f"{value:g}]"


def _definitions(section: str, metrics: list[Metric]) -> str:
    module = import_module(f"benchnav.metrics.{section}")
    lines = [f"## {section.capitalize()}", "", inspect.cleandoc(module.__doc__ or ""), ""]
    for metric in metrics:
        lines += [f"**{metric.name}** — {inspect.getdoc(metric.function)}", ""]
    return "\n".join(lines)


if __name__ == "__main__":
    import sys

    sys.stdout.write(page())
