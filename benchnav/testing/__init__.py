"""Checks shipped to plugin authors."""
