"""One click: every material of the scene that can be spectral is."""

# mypy: disable-error-code="valid-type"

import bpy

from ..choices import ALL_LIGHT, BAKED
from ..grouping import grouped
from ..progress import run
from . import choice, follow, give, operator, properties, update, view


class SKYLIGHT_OT_make_spectral(operator.Long, bpy.types.Operator):
    """Make all materials of the scene spectral and show them in all their light, which is \
computed while you work on. Each uses its chosen file, or an estimate from its base color. \
Materials left alone are listed with the reason. Press Esc to stop"""

    bl_idname = "skylight.make_spectral"
    bl_label = "Make Everything Spectral"
    doing = "Making spectral:"

    estimate: bpy.props.BoolProperty(
        name="Estimate",
        description="Estimate missing reflectances from the base colors of the materials",
        default=True,
    )

    @classmethod
    def disabled_reason(cls, context):
        from ..scene.materials import eligibility

        found = eligibility.may_show_materials(context.scene)
        return operator.no_sky(context) or ("" if found else "No object has a material")

    def run(self, context):
        from ..scene import use_cases

        scene = context.scene
        settings = properties.settings_of(scene.world)
        with_light = settings.occlusion in ALL_LIGHT
        found, lines = run(self._work(context, not with_light)), []
        if with_light and use_cases.in_scene(scene):
            # A script waits for the light; in a window it comes between events, see `follow`.
            lines = run(use_cases.all_light(scene, settings))
        return [*(("INFO", line) for line in lines), *self.finish(context, found)]

    def work(self, context):
        settings = properties.settings_of(context.scene.world)
        return self._work(context, not follow.follows(settings))

    def _work(self, context, relight):
        from ..scene import use_cases

        chosen = choice.of_scene(context.scene)
        settings = properties.settings_of(context.scene.world)
        return use_cases.make_everything_spectral(
            context.scene, chosen, settings, self.estimate, relight
        )

    def finish(self, context, done):
        view.show(context)
        if done is None:
            return [("WARNING", "Stopped: the materials so far are spectral")]
        lines = give.of_results(done.results)
        if properties.settings_of(context.scene.world).occlusion == BAKED:
            lines += update.unbaked(context)
        lines += [("INFO", f"Left alone: {line}") for line in grouped(done.left)]
        return [*lines, *operator.of_light(context.scene), ("INFO", done.line)]


CLASSES = (SKYLIGHT_OT_make_spectral,)
