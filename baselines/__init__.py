"""The shipped plugins, registered through the same entry points as all others."""

if __name__ != "benchnav_baselines":  # the folder's name is not the package's
    raise ImportError("Import benchnav_baselines, not baselines.")
