"""RecurrentPPO, alone or corrected: recipes, training, and the shipped navigators."""
