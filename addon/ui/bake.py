"""Baking the sky's shadows, with a progress bar that Esc ends, and taking bakes away."""

# mypy: disable-error-code="valid-type"

import time

import bpy

from ..errors import InputError
from . import operator, properties, update

SLICE = 0.15  # seconds of work between two looks at the keyboard


class SKYLIGHT_OT_bake(operator.Thin, bpy.types.Operator):
    """Find out what each vertex of the spectral materials sees of the sky. Esc ends it"""

    bl_idname = "skylight.bake"
    bl_label = "Bake Sky Shadows"

    selected: bpy.props.BoolProperty(
        name="Selected Only", description="Leave other objects' bakes as they are"
    )
    changed: bpy.props.BoolProperty(
        name="Changed Only",
        description="Leave objects alone around which nothing has changed",
        default=True,
    )
    rays: bpy.props.IntProperty(
        name="Rays",
        description="From each point; 0: as many as the installed ray caster is good for",
        min=0,
        max=8192,
        step=32,
    )

    @classmethod
    def hindrance(cls, context):
        return update.SKYLIGHT_OT_update.hindrance(context)

    def run(self, context):
        from ..scene import bake

        return self.finish(context, bake.run(self.work(context)))

    def invoke(self, context, event):
        """Start, and work on between events until done."""
        self.generator = self.work(context)
        manager = context.window_manager
        self.timer = manager.event_timer_add(SLICE / 10, window=context.window)
        manager.progress_begin(0, 100)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        """Work for a moment, or end."""
        if event.type == "ESC":
            self.generator.close()
            self.tidy(context)
            return self.end(context, ["the bake was ended before it was done"], "WARNING")
        if event.type == "TIMER":
            until = time.monotonic() + SLICE
            try:
                while time.monotonic() < until:
                    progress = next(self.generator)
            except StopIteration as done:
                self.tidy(context)
                return self.end(context, done.value, "INFO")
            except Exception:
                self.tidy(context)
                raise
            context.window_manager.progress_update(100 * progress.done)
            text = f"Baking {progress.line}: {100 * progress.done:.0f} %. Esc ends"
            context.workspace.status_text_set(text)
        return {"RUNNING_MODAL"}

    def cancel(self, context):
        """End, as Blender asks when a file is closed."""
        self.generator.close()
        self.tidy(context)

    def work(self, context):
        """The generator that bakes, as the properties say."""
        from ..scene import bake, baking

        world = context.scene.world
        rays = max(32, self.rays // 32 * 32) if self.rays else None
        chosen = bake.targets(self.selected)
        settings = properties.settings_of(world)
        return baking.bake(world, settings, chosen, rays=rays, changed_only=self.changed)

    def tidy(self, context):
        """Take timer, progress and status text away."""
        context.window_manager.event_timer_remove(self.timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)

    def end(self, context, lines, level):
        """Light what is baked and report; FINISHED makes one undo step of it all."""
        try:
            lines = self.finish(context, lines, level)
        except InputError as error:
            lines = [("ERROR", str(error))]
        for each, line in lines:
            self.report({each}, line)
        return {"FINISHED"}

    def finish(self, context, lines, level="INFO"):
        """Show bakes in the World, and light them by its sky; return what to report."""
        from ..scene import bake

        told = [(level, line) for line in lines]
        if not bake.baked():
            return told
        context.scene.world.skylight.occlusion = "baked"
        return [*told, *update.SKYLIGHT_OT_update.run(self, context)]


class SKYLIGHT_OT_remove_bakes(operator.Thin, bpy.types.Operator):
    """Take the bakes away from all objects, or the selected ones, without a trace"""

    bl_idname = "skylight.remove_bakes"
    bl_label = "Remove Bakes"

    selected: bpy.props.BoolProperty(name="Selected Only")

    @classmethod
    def hindrance(cls, context):
        from ..scene import bake

        return "" if bake.baked() else "No object is baked"

    def run(self, context):
        from ..scene import bake

        chosen = list(context.view_layer.objects.selected) if self.selected else None
        return [("INFO", f"{bake.remove(chosen)} bake(s) are gone")]


CLASSES = (SKYLIGHT_OT_bake, SKYLIGHT_OT_remove_bakes)
