"""Groups that follow the recorded trajectory of their leader, and avoid each other with ORCA."""
