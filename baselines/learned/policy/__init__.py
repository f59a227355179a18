"""Policies of other libraries as navigators: Stable-Baselines3, sb3-contrib, and ONNX files."""
