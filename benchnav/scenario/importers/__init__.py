"""Readers of other projects' files, and the scenarios that are made of them."""
