"""Model predictive path integral control (Williams et al. 2017).

Tuned: 65 settings, each on 24 to 78 validation worlds of `leaders/dynamic`,
`corridor/bidirectional`, `circle/antipodal` and, for the last 9, `office/rooms`, behind
`ompl.rrt-connect`.
"""
