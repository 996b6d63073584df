"""A scene's World: its sky as a panorama, its groups, its settings and its view."""
