"""RecurrentPPO with collision prediction: recipes, training, and the navigators that ship."""
