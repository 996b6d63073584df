"""Pictures rendered from a scene, whole or not at all."""
