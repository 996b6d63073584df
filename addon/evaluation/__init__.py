"""How exact and how fast every method is: what `evaluate` and `chart` measure. Never in Blender."""
