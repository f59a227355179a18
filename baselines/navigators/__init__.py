"""Navigators that are not a single planner or controller."""
