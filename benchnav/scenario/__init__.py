"""Scenario descriptions, and how they are read from YAML files."""
