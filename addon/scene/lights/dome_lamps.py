"""The sky as a dome of soft suns: its shadows in Eevee without a bake, also of what moves."""

from __future__ import annotations

import math

import bpy
from mathutils import Vector

from ....node_groups import light_probe
from ...sky.dome import Dome
from . import sun_lamp

DOME = "dome"


def place(scene: bpy.types.Scene, dome: Dome) -> None:
    """Give a scene the lamps of a dome in place of those that it had; they turn with the World."""
    sun_lamp.remove(scene, (DOME,))
    pivot = sun_lamp.pivot(scene)
    for towards, numbers in zip(dome.towards, dome.numbers, strict=True):
        lamp = sun_lamp.new_lamp(scene, "Skylight Dome", "SUN", DOME, 1)
        lamp.parent = pivot
        lamp.rotation_euler = (-Vector(towards)).to_track_quat("-Z", "Y").to_euler()
        light = lamp.data
        light.angle = 2.0 * math.acos(1.0 - dome.solid_angle / (2.0 * math.pi))
        light.energy = light_probe.STRENGTH * dome.solid_angle
        light.color = (sun_lamp.FAINT, *numbers)
        # In Cycles the sky is open: there the dome is dark.
        sun_lamp.set_cycles_colour(lamp, (0.0, 0.0, 0.0), 1)
