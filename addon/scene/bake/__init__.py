"""What each point of a scene sees of the sky, kept in a mesh of ours."""
