"""Measure the success that full knowledge makes possible, as a reference for navigators.

A search plans for every agent ahead of time. It knows the map, the laws of the dynamic
obstacles and the plans of the other agents. The simulator then executes the plans. This is a
measurement and not a navigator: a navigator must not know the laws.

A plan that is found proves that the goal can be reached. A plan that is not found proves
nothing, because the search has a lattice of commands and a budget. The measured success is
therefore a lower bound, and agents without a plan are reported separately.
"""
