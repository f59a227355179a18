"""The smallest scenario: one agent that crosses an empty square."""

PLAIN = """\
name: tests/plain
bounds: [-5, -5, 5, 5]
teams:
  - name: one
    radius: 0.2
    max_speed: 1
    start: {type: points, points: [[-4, 0]]}
    goal: {type: points, points: [[4, 0]]}
"""
