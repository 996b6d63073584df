"""Blend files and asset libraries on disk."""
