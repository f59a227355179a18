"""Readers whose memory and time are bounded, for files from strangers."""
