"""Meshes, occupancy images and recorded tracks that scenarios name."""
