"""Bringing the spectral materials up to date with the sky."""

from collections.abc import Generator

import bpy

from ..grouping import some
from ..progress import Progress
from . import choice, follow, give, operator, properties, staleness_handlers


def nothing_to_update(context: bpy.types.Context) -> str:
    """Why there is nothing to bring up to date, empty where there is."""
    from ..scene.materials import spectral_material

    nothing = "No material is spectral yet. Press Make Everything Spectral first"
    return operator.no_sky(context) or ("" if spectral_material.ours() else nothing)


def updating(context: bpy.types.Context) -> Generator[Progress, None, give.Lines]:
    """Let materials follow the sky, and say which files and bakes have changed since."""
    from ..scene import use_cases

    world = context.scene.world
    settings = properties.settings_of(world)
    relight = not follow.follows(settings)
    found = yield from use_cases.updating(context.scene, settings, relight=relight)
    lines = give.warnings(found.skipped)
    lines += give.of_results(found.results)
    changed, gone = choice.changed_files(use_cases.in_scene(context.scene))
    staleness_handlers.found_files(changed)
    lines += [("WARNING", f"{material.name}: {line}") for material, line in changed.items()]
    lines += [("INFO", line) for line in gone]
    if relight:
        lines += unbaked(context)
    name = "" if found.light is None else found.light.name
    lines.append(("INFO", f"Updated {len(found.results)} material(s) to {name}"))
    return [*lines, *operator.of_light(context.scene)]


def unbaked(context: bpy.types.Context) -> give.Lines:
    """Look at the scene's bakes, and warn of those that are missing or old."""
    from ..scene import out_of_date

    names = out_of_date.look_at_bakes(context.scene)
    staleness_handlers.found_bakes()
    if not names:
        return []
    return [("WARNING", f"Not baked, or changed since: {some(names, 'object')}")]


class SKYLIGHT_OT_update(operator.Long, bpy.types.Operator):
    """Update spectral materials after a change of the HDRI, the settings or the lamps, and list \
files, bakes and base colors that have changed"""

    bl_idname = "skylight.update"
    bl_label = "Update"
    doing = "Updating"

    @classmethod
    def disabled_reason(cls, context):
        return nothing_to_update(context)

    def work(self, context):
        return updating(context)


CLASSES = (SKYLIGHT_OT_update,)
