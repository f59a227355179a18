"""What a YAML file says, and how it is read."""
