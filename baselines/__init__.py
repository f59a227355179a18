"""What ships as plugins, registered through the same entry points as anybody's."""

if __name__ != "benchnav_baselines":  # the folder's name is not the package's
    raise ImportError("Import benchnav_baselines, not baselines.")
