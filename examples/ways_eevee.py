"""Eevee without the add-on: as it comes, and with all that one can set up in it by hand."""

from collections.abc import Iterator

import bpy
import numpy as np
from ready import Ready
from way import Clock, Shot, Way, megabytes, opened, rendered


def eevee(by_hand: bool = False) -> Way:
    """Eevee without the add-on; ``by_hand``: ray tracing, and a baked light-probe volume."""

    def shots(ready: Ready, more: bool) -> Iterator[Shot]:
        scene, setup = opened(ready), Clock()
        if by_hand:
            _trace_rays(scene)
            with setup:
                _bake_probes(scene)
        picture, seconds = rendered(scene, ready, "eevee")
        frame = rendered(scene, ready, "eevee")[1] if more else seconds
        # Values alone change; probes are baked anew, which takes as long as at first.
        again = {"frame": frame, "hour": setup.seconds + frame, "paint": setup.seconds + frame}
        yield Shot(picture, setup.seconds + seconds, setup.seconds, again, megabytes())

    return Way("Eevee", "rays and probes" if by_hand else "as it comes", shots)


PROBES = 8
"""Light probes along the longest edge of the volume."""


def _trace_rays(scene: bpy.types.Scene) -> None:
    """Let Eevee trace rays on the screen, at full size and as far as it can."""
    settings = scene.eevee
    settings.use_raytracing = True
    settings.ray_tracing_method = "SCREEN"
    options = settings.ray_tracing_options
    options.resolution_scale, options.trace_max_roughness = "1", 1.0  # matt surfaces too
    options.screen_trace_quality, options.screen_trace_thickness = 1.0, 0.5


def _bake_probes(scene: bpy.types.Scene) -> None:
    """Bake one volume of light probes around what stands in the scene, its wide ground apart."""
    probe = next((obj for obj in scene.objects if obj.type == "LIGHT_PROBE"), None)
    if probe is None:
        corners = [
            (obj.matrix_world @ vertex.co)[:]
            for obj in scene.objects
            if obj.type == "MESH" and max(obj.dimensions) < 40.0
            for vertex in obj.data.vertices
        ]
        low, high = np.min(corners, axis=0) - 0.3, np.max(corners, axis=0) + 0.3
        data = bpy.data.lightprobes.new("probes", "VOLUME")
        probe = bpy.data.objects.new("probes", data)
        probe.location, probe.scale = ((low + high) / 2).tolist(), ((high - low) / 2).tolist()
        scene.collection.objects.link(probe)
        counts = np.clip(np.ceil(PROBES * (high - low) / (high - low).max()), 4, None).astype(int)
        data.resolution_x, data.resolution_y, data.resolution_z = counts.tolist()
        data.bake_samples = 64
    for other in scene.objects:
        other.select_set(other == probe)
    bpy.context.view_layer.objects.active = probe
    bpy.ops.object.lightprobe_cache_bake(subset="ALL")
