"""Episodes as recordings that the 3-D viewers of the field open: Rerun and MCAP files."""
