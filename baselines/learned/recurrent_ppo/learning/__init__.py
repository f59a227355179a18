"""Training: recipes, learners, checkpoints and logs."""
