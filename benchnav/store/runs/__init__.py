"""Run folders: manifest, lock, reading and merging."""
