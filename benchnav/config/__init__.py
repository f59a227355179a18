"""YAML files: reading and validation."""
