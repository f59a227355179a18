"""Navigators, planners, controllers, and what they are told."""
