"""The add-on's shader node groups: one builder a file, updated in place, nothing but bpy."""
