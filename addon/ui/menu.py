"""The menu Object › Spectral Skylight; Blender's search (F3) finds what a menu holds, no more."""

import bpy

STEPS = (
    ("open_example", "load_sky", "use_world", "make_sky", "animate"),
    ("make_spectral", "update", "remove_all"),
    ("refine_sky", "stop_refining"),
    ("choose_reflectance", "apply", "apply_selected", "apply_all", "estimate"),
    ("remove", "remove_selected"),
    ("explain", "measure"),
    ("assign_to_active", "assign_to_selected"),
    ("write_assignments", "read_assignments"),
    ("browse_library", "refresh_library", "library_problems", "write_assets"),
    ("bake", "stop_light", "remove_bakes"),
    ("show_in_viewport", "before_after", "split_view", "view_as", "neutral_white"),
    ("false_color", "sunlight", "hide_false_color"),
    ("batch_write", "batch_start", "batch_cancel"),
    ("help",),
)


class SKYLIGHT_MT_object(bpy.types.Menu):
    """All that the panels' buttons do."""

    bl_label = "Spectral Skylight"

    def draw(self, context):
        layout = self.layout
        layout.operator_context = "INVOKE_DEFAULT"  # with file browser, progress and Esc
        for step in STEPS:
            layout.separator()
            for name in step:
                layout.operator(f"skylight.{name}")


def attach() -> None:
    """Hang the menu into the 3D view's Object menu."""
    bpy.types.VIEW3D_MT_object.append(_draw)


def detach() -> None:
    """Take it out."""
    bpy.types.VIEW3D_MT_object.remove(_draw)


def _draw(menu, context) -> None:
    menu.layout.separator()
    menu.layout.menu(SKYLIGHT_MT_object.__name__)


CLASSES = (SKYLIGHT_MT_object,)
