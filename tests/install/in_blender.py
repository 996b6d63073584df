"""Install the add-on in a bare Blender and use it; run there, not by pytest.

    python in_blender.py use ZIP SKY.exr PAINTS.csv ANSWER.json
    python in_blender.py upgrade URL URL SKY.exr PAINTS.csv ANSWER.json
    python in_blender.py offline ZIP ANSWER.json
    python in_blender.py render SCENE.blend ANSWER.json

With BLENDER_USER_RESOURCES=FOLDER. `use` installs a zip from disk, makes two materials spectral,
and saves and renders the file beside the answer. `upgrade` does so from one repository's address,
and again with what another has; the file is the older version's. `offline` asks for a farm beyond
this machine without leave to. `render` renders a file in a Blender without the add-on.
"""

import importlib
import json
import os
import sys
from pathlib import Path

import bpy

REPOSITORY = "skylight_tests"
HEAVY = {"colour", "scipy", "OpenEXR", "matplotlib", "pandas", "tqdm"}


def module():
    """The name of the add-on's module, whichever repository it came from."""
    (name,) = installed()
    return name


def installed():
    names = [each.module for each in bpy.context.preferences.addons]
    return [name for name in names if name.endswith("spectral_skylight")]


def version():
    manifest = Path(sys.modules[module()].__file__).with_name("blender_manifest.toml")
    lines = manifest.read_text(encoding="utf-8").splitlines()
    return next(line.split('"')[1] for line in lines if line.startswith("version"))


def use(archive, sky, paints, answer):
    """From disk, as the preferences' button does."""
    bpy.ops.extensions.package_install_files(
        filepath=archive, repo="user_default", enable_on_install=True
    )
    work(sky, paints, answer)


def get(url, sky, paints, answer):
    """From a repository, as its address in the preferences does."""
    bpy.context.preferences.system.use_online_access = True
    bpy.context.preferences.extensions.repos.new(
        name="Skylight Tests", module=REPOSITORY, remote_url=url
    )
    sync()
    bpy.ops.extensions.package_install(
        repo_index=index(), pkg_id="spectral_skylight", enable_on_install=True
    )
    work(sky, paints, answer)


def index():
    names = [repo.module for repo in bpy.context.preferences.extensions.repos]
    return names.index(REPOSITORY)


def sync():
    bpy.ops.extensions.repo_sync(repo_index=index())


def work(sky, paints, answer):
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
    tell(answer)


def tell(answer):
    materials = importlib.import_module(module() + ".addon.scene.materials.spectral_material")
    matrices = {
        name: [list(row) for row in materials.managed(bpy.data.materials[name]).matrix]
        for name in ("red", "blue")
    }
    heavy = sorted(HEAVY & {name.partition(".")[0] for name in sys.modules})
    told = {"matrices": matrices, "heavy": heavy, "version": version(), "pixels": pixels(answer)}
    Path(answer).write_text(json.dumps(told))


def upgrade(older, newer, sky, paints, answer):
    """From a repository, a scene made, then what the repository has by now, and that scene."""
    get(older, sky, paints, answer)
    first = json.loads(Path(answer).read_text())
    bpy.context.preferences.extensions.repos[index()].remote_url = newer
    sync()
    bpy.ops.extensions.package_upgrade_all()
    bpy.ops.wm.open_mainfile(filepath=str(Path(answer).with_suffix(".blend")))
    bpy.ops.skylight.update()
    tell(answer)
    then = json.loads(Path(answer).read_text())
    Path(answer).write_text(json.dumps([first, then]))


def offline(archive, answer):
    """A farm's address that is not this machine's, while Blender may not go online."""
    bpy.ops.extensions.package_install_files(
        filepath=archive, repo="user_default", enable_on_install=True
    )
    bpy.context.preferences.system.use_online_access = False
    errors = importlib.import_module(module() + ".addon.errors")
    submit = importlib.import_module(module() + ".addon.batch.flamenco.submit")
    said = {}
    for address in ("http://farm.example:8080", "http://127.0.0.1:9"):
        try:
            submit.workers_of(address)
        except errors.InputError as error:
            said[address] = str(error)
    Path(answer).write_text(json.dumps(said))


def render(scene_file, answer):
    assert not installed()
    bpy.ops.wm.open_mainfile(filepath=scene_file)
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
    tasks = {task.__name__: task for task in (use, upgrade, offline, render)}
    tasks[sys.argv[1]](*sys.argv[2:])
    sys.stdout.flush()
    os._exit(0)  # bpy before 5.0 can crash at interpreter exit
