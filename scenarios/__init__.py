"""Scenario and suite files; found through importlib.resources, never by path."""

if __name__ != "benchnav_scenarios":  # the folder's name is not the package's
    raise ImportError("Import benchnav_scenarios, not scenarios.")
