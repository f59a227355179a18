"""Navigators as plugins: configuration, contract and capabilities."""
