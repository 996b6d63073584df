"""Spectral Skylight: spectrally correct colours under sky HDRIs in Blender."""


def register() -> None:
    """Register the add-on's classes, properties and command with Blender."""
    from .addon import registration

    registration.register()


def unregister() -> None:
    """Undo `register`, leaving blend data as it is."""
    from .addon import registration

    registration.unregister()
