"""Robot files, one a robot; found through importlib.metadata, never by path."""

if __name__ != "benchnav_robots":  # the folder's name is not the package's
    raise ImportError("Import benchnav_robots, not robots.")
