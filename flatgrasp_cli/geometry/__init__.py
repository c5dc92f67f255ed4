"""Plane and solid geometry on numpy arrays; knows nothing of grasping."""
