"""Navigators that are no single planner or controller."""
