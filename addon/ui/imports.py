"""The modules that panels and buttons need, imported one by one while a person looks around.

Together they would hold up the first look at the panel, most of all after an installation.
"""

from __future__ import annotations

import importlib

import bpy

PACKAGE = __package__.rpartition(".")[0]

MODULES = (
    "spectra.grid",
    "spectra.sensitivities",
    "spectra.working_spaces",
    "sky.irradiance",
    "sky.light",
    "transfer.matrices",
    "transfer.choice",
    "transfer.assignment",
    "transport.radiosity",
    "scene.world.hdri",
    "scene.world.panorama",
    "scene.materials.spectral_material",
    "scene.lights.lighting",
    "scene.bake.matter",
    "scene.bake.session",
    "scene.plan",
    "scene.use_cases",
)
"""Each needs those before it."""

_left: list[str] = []


def _import() -> float | None:
    if _left:
        importlib.import_module(f"{PACKAGE}.{_left.pop(0)}")
    return 0.02 if _left else None


def attach() -> None:
    """Begin, where there is a window."""
    if not bpy.app.background:
        _left[:] = MODULES
        bpy.app.timers.register(_import, first_interval=0.02)


def detach() -> None:
    """Import no more."""
    _left.clear()
