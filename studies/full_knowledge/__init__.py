"""What full knowledge could reach: a reference for navigators that must do without.

Every agent of a world is planned for ahead of time by one who knows the map, the laws of
the movers and the other agents' plans; the real simulator then drives the plans and
judges them. It is a measurement and no navigator: a navigator may not see laws.

A plan that is found shows what can be done. One that is not found shows nothing: the
search has a lattice of commands and a budget. So the success measured is a lower bound
of what is possible, and the part not found is said apart.
"""
