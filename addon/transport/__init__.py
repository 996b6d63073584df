"""Light between surfaces, all bounces, in bands: geometry and arithmetic, without Blender."""
