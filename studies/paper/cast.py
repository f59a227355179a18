"""The labels of navigators and the scenarios in the suite ``paper``, by their part in it."""

BLIND = "straight-line"  # equal to a planner with an empty map
PLANNER = "navmesh+path-following"
ONCE = "navmesh+path-following once"  # plans once in an episode
MAPPER = "mapping+visibility+path-following"
LOCAL = "orca"
BOTH = "navmesh+orca"
MAPPING_BOTH = "mapping+visibility+orca"
TABULAR = "q-learning"
GRID = "q-learning-grid"
PAPER = "recurrent-ppo"
PLUS = "recurrent-ppo-plus"
HYBRID = "map-orca-ppo"
GUIDED = "guided by recurrent-ppo"
GUIDED_PLUS = "guided by recurrent-ppo-plus"

STATIC, MOVED, FURNITURE = "leaders/static", "leaders/moved", "leaders/moving-furniture"
DYNAMIC, TRAP, MAZE, GROUPS = "leaders/dynamic", "trap/u", "maze/grid", "groups/diagonal"
