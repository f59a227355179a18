"""Learning environments over the benchmark's own worlds, sensors and contacts."""
