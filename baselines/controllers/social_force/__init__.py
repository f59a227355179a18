"""The social force model (Helbing & Molnár 1995).

Distances between bodies are measured from rim to rim: the paper's pedestrians are points whose
size is part of the potentials; here every body has a radius, and touching is a failure. Distances
to borders are measured from the centre for bodies of up to 0.4 m, and from 0.4 m within a larger
body: measured from the rim, the published force of two door posts stops every agent.

The constants are the paper's. Δt and the two distances are tuned: 31 settings, each on 12
validation worlds of `leaders/dynamic`, `corridor/bidirectional` and `circle/antipodal` behind
`ompl.rrt-connect` or `visibility`, 20 of them also on 2 to 4 of `office/rooms`.
"""
