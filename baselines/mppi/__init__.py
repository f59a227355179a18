"""Model predictive path integral control (Williams et al. 2017)."""
