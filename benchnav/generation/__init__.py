"""The generation of worlds: (scenario, split, seed) → world."""
