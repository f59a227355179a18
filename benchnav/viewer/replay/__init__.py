"""Replays: episodes as pages that a browser plays from disk, without a network."""
