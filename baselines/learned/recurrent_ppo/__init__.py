"""RecurrentPPO, alone and with collision prediction: recipes, training, and the shipped navigators."""
