"""The dynamic window approach (Fox, Burgard & Thrun 1997).

Tuned: 79 settings, each on 16 to 71 validation worlds of `leaders/dynamic`,
`corridor/bidirectional` and, for the last 12, `office/rooms`, behind `ompl.rrt-connect`.
"""
