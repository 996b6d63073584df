"""Skies: read from files, taken apart for lighting, and simulated. Without Blender."""
