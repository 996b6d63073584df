"""Blender's side of a window test: it answers what the test asks about Blender's state.

Started by ``blender --python agent.py -- FOLDER``. The test writes an expression to FOLDER/ask; the
value comes back, as JSON, in FOLDER/answer. What is pressed is pressed by xdotool, not from here.
"""

import importlib
import json
import sys
import traceback
from pathlib import Path

import bpy
import numpy as np

FOLDER = Path(sys.argv[sys.argv.index("--") + 1])
sys.path.insert(0, str(FOLDER))
freezes = importlib.import_module("freezes")


def region(area_type, region_type):
    """Box of the first such region on the screen, as (left, top, width, height) in pixels."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            for part in area.regions:
                if (area.type, part.type) == (area_type, region_type) and part.width > 1:
                    top = window.height - part.y - part.height
                    return part.x, top, part.width, part.height
    return None


def at_work():
    """Whether an operator of ours goes on; one that waits for a file does not."""
    windows = bpy.context.window_manager.windows
    if any(area.type == "FILE_BROWSER" for window in windows for area in window.screen.areas):
        return False
    running = [op.bl_idname for window in windows for op in window.modal_operators]
    return any(name.startswith("SKYLIGHT") for name in running)


def ours(module):
    """A module of the add-on, by its name below the root."""
    return importlib.import_module(f"bl_ext.user_default.spectral_skylight.{module}")


def following():
    """Whether light is being computed, or is to be."""
    follow = ours("addon.ui.follow")
    return follow.work() is not None or follow.waiting()


def light(name):
    """The mean green of an object's baked light, None without any."""
    storage = ours("addon.scene.bake.storage")
    bake = storage.bake_of(bpy.data.objects[name])
    found = None if bake is None else bake.data.attributes.get("skylight_light")
    if found is None:
        return None
    values = np.empty(4 * len(found.data), np.float32)
    found.data.foreach_get("color", values)
    values = values.reshape(-1, 4)
    return float(values[values[:, 3] > 0, 1].mean())


def lit():
    """The names of objects whose bakes hold light."""
    package = "bl_ext.user_default.spectral_skylight"
    storage = importlib.import_module(package + ".addon.scene.bake.storage")
    return [obj.name for obj in bpy.data.objects if storage.is_lit(obj)]


def shading():
    """How the first 3D view is shown."""
    for area in bpy.context.window_manager.windows[0].screen.areas:
        if area.type == "VIEW_3D":
            return area.spaces.active.shading.type
    return None


def solid():
    """Show no light in the 3D views: in software each frame of it takes seconds."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.spaces.active.shading.type = "SOLID"


def matrix(name):
    """The matrix that a material was given, None without."""
    materials = ours("addon.scene.materials.spectral_material")
    found = materials.managed(bpy.data.materials[name])
    return found and [list(row) for row in found.matrix]


def near(name, wanted):
    """Whether a material has this matrix, None for none, or nearly so."""
    found = matrix(name)
    if found is None or wanted is None:
        return found is wanted
    return bool(np.abs(np.subtract(found, wanted)).max() < 1e-4)


def village(across):
    """A field with so many times so many boxes of 26 faces each in 24 colors, and one fine dome."""
    if (cube := bpy.data.objects.get("Cube")) is not None:
        bpy.data.objects.remove(cube)
    paints = [bpy.data.materials.new(f"Paint {k}") for k in range(24)]
    for k, paint in enumerate(paints):
        color = 0.1 + 0.03 * k, 0.8 - 0.03 * k, 0.3, 1.0
        next(n for n in paint.node_tree.nodes if n.type == "BSDF_PRINCIPLED").inputs[
            "Base Color"
        ].default_value = color
    side = 4.0 * across
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=40, y_subdivisions=40, size=side)
    bpy.context.object.name = "Field"
    bpy.context.object.data.materials.append(paints[0])
    bpy.ops.mesh.primitive_uv_sphere_add(segments=96, ring_count=48, radius=3, location=(0, 0, 6))
    bpy.context.object.data.materials.append(paints[1])
    bpy.ops.mesh.primitive_cube_add(size=1.5)
    first = bpy.context.object
    first.modifiers.new("Edges", "BEVEL")
    for k in range(across**2):
        mesh = first.data.copy()
        mesh.materials.append(paints[k % 24])
        box = bpy.data.objects.new(f"Box {k}", mesh)
        box.modifiers.new("Edges", "BEVEL")
        box.location = 4.0 * (k % across) - side / 2, 4.0 * (k // across) - side / 2, 0.75
        bpy.context.scene.collection.objects.link(box)
    bpy.data.objects.remove(first)


def listen():
    ask, answer = FOLDER / "ask", FOLDER / "answer"
    if ask.exists():
        expression = ask.read_text()
        ask.unlink()
        try:
            said = {"value": eval(expression, globals())}  # the test's own words
        except Exception:
            said = {"error": traceback.format_exc()}
        part = answer.with_suffix(".part")
        part.write_text(json.dumps(said, default=str))
        part.replace(answer)
    return 0.1


view = bpy.context.preferences.view
view.show_splash = False
view.filebrowser_display_type = "SCREEN"  # there is no window manager to place another window
bpy.context.scene.eevee.taa_samples = 1  # each takes seconds in software
bpy.app.timers.register(listen, persistent=True)
watched = freezes.Freezes()
(FOLDER / "started").touch()
