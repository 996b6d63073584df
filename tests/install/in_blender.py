"""Install a zip in a bare Blender and use it; run there, not by pytest, and not importing ours.

    BLENDER_USER_RESOURCES=FOLDER python in_blender.py use ZIP SKY.exr PAINTS.csv ANSWER.json
    BLENDER_USER_RESOURCES=FOLDER python in_blender.py look ZIP ANSWER.json
    BLENDER_USER_RESOURCES=FOLDER python in_blender.py render SCENE.blend ANSWER.json

`use` makes two materials spectral, and saves and renders the file beside the answer; `look` only
says what the panel shows; `render` renders a file in a Blender without the add-on.
"""

import importlib
import json
import os
import sys
from pathlib import Path
from types import SimpleNamespace

import bpy

MODULE = "bl_ext.user_default.spectral_skylight"


def install(archive):
    """Install from disk and enable, as the preferences' button does; the add-on's module."""
    bpy.ops.extensions.package_install_files(
        filepath=archive, repo="user_default", enable_on_install=True
    )
    assert MODULE in bpy.context.preferences.addons, "Blender did not enable the add-on"
    return sys.modules[MODULE]


def use(archive, sky, paints, answer):
    install(archive)
    bpy.ops.wm.read_homefile(use_empty=True)
    scene = bpy.context.scene
    for place, name in ((-1.1, "red"), (1.1, "blue")):
        bpy.ops.mesh.primitive_plane_add(location=(place, 0, 0))
        material = bpy.data.materials.new(name)
        if bpy.app.version < (5, 0, 0):
            material.use_nodes = True
        bpy.context.object.data.materials.append(material)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location.z = 5
    scene.collection.objects.link(camera)
    scene.camera = camera
    bpy.ops.skylight.load_sky(filepath=sky)
    scene.world.skylight.basis = "atmosphere"  # and not the simplest that will do
    for name in ("red", "blue"):
        bpy.ops.skylight.apply(material=name, filepath=paints, column=name)
    scene_file = Path(answer).with_suffix(".blend")
    bpy.ops.wm.save_as_mainfile(filepath=str(scene_file))
    materials = importlib.import_module(MODULE + ".addon.scene.materials.spectral_material")
    wheels = importlib.import_module(MODULE + ".addon.ui.wheels")
    matrices = {
        name: [list(row) for row in materials.managed(bpy.data.materials[name]).matrix]
        for name in ("red", "blue")
    }
    modules = {name: sys.modules[name].__file__ for name in ("colour", "scipy", "OpenEXR", "numpy")}
    told = {"matrices": matrices, "modules": modules, "missing": wheels.missing()}
    Path(answer).write_text(json.dumps({**told, "pixels": pixels(answer)}))


def look(archive, answer):
    install(archive)
    wheels = importlib.import_module(MODULE + ".addon.ui.wheels")
    poll = bpy.ops.skylight.load_sky.poll()
    labels = []
    column = SimpleNamespace(label=lambda text, **_: labels.append(text))
    layout = SimpleNamespace(column=lambda **_: column, operator=lambda *_, **__: None)
    panel = bpy.types.SKYLIGHT_PT_main
    panel.draw(SimpleNamespace(layout=layout), bpy.context)
    told = {"missing": wheels.missing(), "poll": poll, "panel": " ".join(labels)}
    Path(answer).write_text(json.dumps(told))


def render(scene_file, answer):
    bpy.ops.wm.open_mainfile(filepath=scene_file)
    assert MODULE not in bpy.context.preferences.addons
    Path(answer).write_text(json.dumps({"pixels": pixels(answer)}))


def pixels(answer):
    """Scene-linear RGB at the middle of both planes, by Cycles."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 4
    scene.cycles.use_denoising = False
    scene.render.resolution_x = scene.render.resolution_y = 16
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.filepath = str(Path(answer).with_suffix(".exr"))
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    image.colorspace_settings.name = "Non-Color"
    values = list(image.pixels)
    return [values[4 * (8 * 16 + x) :][:3] for x in (4, 11)]


if __name__ == "__main__":
    {"use": use, "look": look, "render": render}[sys.argv[1]](*sys.argv[2:])
    sys.stdout.flush()
    os._exit(0)  # bpy before 5.0 can crash at interpreter exit
