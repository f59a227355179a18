"""The scenario files that ship, and a small one."""

from pathlib import Path

SHIPPED = sorted(
    path
    for path in (Path(__file__).parents[2] / "scenarios").glob("*/*.yaml")
    if path.parent.name != "suites"
)

SMALL = """\
name: tests/small
bounds: [0, 0, 10, 10]
walls:
  - shape: {type: box, width: 1, depth: 2}
    at: [5, 5]
static:
  - shape: {type: disc, radius: 0.5}
    count: {integers: [1, 3]}
    region: {type: anywhere}
    gap: 0.5
dynamic:
  - shape: {type: disc, radius: 0.3}
    region: {type: ring, center: [5, 5], inner: 2, outer: 3}
    law: {type: back-and-forth, length: 1, speed: 1}
teams:
  - name: walkers
    count: 2
    radius: 0.2
    max_speed: 1.5
    start: {type: region, region: {type: rectangle, bounds: [0, 0, 2, 10]}}
    goal: {type: region, region: {type: disc, center: [8, 5], radius: 1.5}, min_distance: 2}
  - name: others
    radius: 0.2
    max_speed: 1
    start: {type: points, points: [[5, 1]]}
    goal: {type: antipodal, center: [5, 5]}
    driver: {type: straight-line}
    ignores: [walkers]
"""
