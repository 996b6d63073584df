"""Blender's data blocks: node trees, drivers, fingerprints, working space."""
