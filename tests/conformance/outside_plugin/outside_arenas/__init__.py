"""Scenarios and suites of another package; only its files are read."""

raise RuntimeError("benchnav must not import a package of scenarios")
