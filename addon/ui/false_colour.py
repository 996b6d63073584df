"""Amounts of light in false colors over what 3D views show, with isolines and a legend.

It is drawn over the view: no material, no attribute and no setting of the file changes, and Blender
compiles none of its shaders. Amounts are those of the moment at which they were measured.
"""

# mypy: disable-error-code="valid-type"

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import bpy

from ..choices import QUANTITIES, items
from . import operator, properties
from .translation import translated

_VERTEX = """
void main() {
  side_amounts = amounts;
  gl_Position = to_screen * vec4(place, 1.0);
  gl_Position.z -= 2e-5 * gl_Position.w;  /* in front of the surfaces that it lies on */
}
"""

_FRAGMENT = """
void main() {
  float amount = gl_FrontFacing ? side_amounts.x : side_amounts.y;
  if (amount < 0.0) discard;  /* within something solid */
  float t = ends.z > 0.5 ? log(max(amount, ends.x) / ends.x) / log(ends.y / ends.x)
                         : (amount - ends.x) / (ends.y - ends.x);
  t = clamp(t, 0.0, 1.0);
  float step = clamp(fwidth(t), 1e-5, 0.1) * 0.7;
  int last = textureSize(colors, 0).x - 1;
  vec4 here = texelFetch(colors, ivec2(int(t * last + 0.5), 0), 0);
  float below = texelFetch(colors, ivec2(int(clamp(t - step, 0.0, 1.0) * last + 0.5), 0), 0).a;
  float above = texelFetch(colors, ivec2(int(clamp(t + step, 0.0, 1.0) * last + 0.5), 0), 0).a;
  vec3 shown = below != above ? vec3(0.0) : here.rgb;
  FragColor = vec4(shown, 1.0);
}
"""


@dataclass
class _Shown:
    """What views show of a `surface_light.Drawing` or an `exposure.Drawing`."""

    drawing: Any
    quantity: str
    scale: Any
    changed: bool = False
    """Whether something has moved since."""
    batch: Any = None
    colors: Any = None
    shader: Any = None
    handles: list[Any] = field(default_factory=list)


_shown: list[_Shown] = []


def shown() -> str:
    """Which quantity views show, empty for none."""
    return _shown[0].quantity if _shown else ""


def show(drawing: Any, quantity: str) -> None:
    """Let 3D views show a quantity of a `surface_light.Drawing` or an `exposure.Drawing`."""
    hide()
    found = _Shown(drawing, quantity, drawing.scale(quantity))
    _shown.append(found)
    if not bpy.app.background:
        for draw, when in ((_draw_surfaces, "POST_VIEW"), (_draw_legend, "POST_PIXEL")):
            handle = bpy.types.SpaceView3D.draw_handler_add(draw, (), "WINDOW", when)
            found.handles.append(handle)
    bpy.app.handlers.depsgraph_update_post.append(_notice)
    bpy.app.handlers.load_pre.append(_forget)
    _redraw()


def hide() -> None:
    """Show no amounts any more."""
    for found in _shown:
        for handle in found.handles:
            bpy.types.SpaceView3D.draw_handler_remove(handle, "WINDOW")
    _shown.clear()
    for handlers, ours in (
        (bpy.app.handlers.depsgraph_update_post, _notice),
        (bpy.app.handlers.load_pre, _forget),
    ):
        if ours in handlers:
            handlers.remove(ours)
    _redraw()


@bpy.app.handlers.persistent
def _notice(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """Note that what is shown is of a scene that has changed."""
    for update in depsgraph.updates:
        moved = update.is_updated_geometry or update.is_updated_transform
        if moved and isinstance(update.id, bpy.types.Object) and update.id.type != "CAMERA":
            _shown[0].changed = True


@bpy.app.handlers.persistent
def _forget(*_: object) -> None:
    """Show nothing of a file that is closed."""
    hide()


def _redraw() -> None:
    for window in bpy.context.window_manager.windows if bpy.context.window_manager else ():
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


def _compiled() -> Any:
    import gpu

    info = gpu.types.GPUShaderCreateInfo()
    between = gpu.types.GPUStageInterfaceInfo("skylight_false_color")
    between.smooth("VEC2", "side_amounts")
    info.vertex_in(0, "VEC3", "place")
    info.vertex_in(1, "VEC2", "amounts")
    info.vertex_out(between)
    info.push_constant("MAT4", "to_screen")
    info.push_constant("VEC4", "ends")
    info.sampler(0, "FLOAT_2D", "colors")
    info.fragment_out(0, "VEC4", "FragColor")
    info.vertex_source(_VERTEX)
    info.fragment_source(_FRAGMENT)
    return gpu.shader.create_from_info(info)


def _prepare(found: _Shown) -> None:
    """Send triangles and colors to the graphics card.

    Colors are linear: Blender encodes what is drawn over a view, and only its own shaders decode
    theirs before.
    """
    import gpu
    from gpu_extras.batch import batch_for_shader

    from ..pictures import false_colour

    found.shader = _compiled()
    given = {"place": found.drawing.places, "amounts": found.drawing.sides(found.quantity)}
    found.batch = batch_for_shader(found.shader, "TRIS", given)
    texels = false_colour.texels(found.scale)
    data = gpu.types.Buffer("FLOAT", texels.size, texels.ravel().tolist())
    found.colors = gpu.types.GPUTexture((len(texels), 1), format="RGBA32F", data=data)


def _draw_surfaces() -> None:
    import gpu

    found = _shown[0]
    if found.batch is None:
        _prepare(found)
    scale = found.scale
    gpu.state.depth_test_set("LESS_EQUAL")
    gpu.state.depth_mask_set(True)
    found.shader.bind()
    found.shader.uniform_float("to_screen", bpy.context.region_data.perspective_matrix)
    found.shader.uniform_float("ends", (scale.low, scale.high, float(scale.logarithmic), 0.0))
    found.shader.uniform_sampler("colors", found.colors)
    found.batch.draw(found.shader)
    gpu.state.depth_mask_set(False)
    gpu.state.depth_test_set("NONE")


def _draw_legend() -> None:
    """A bar at the right with round amounts beside it, and what they are of."""
    import blf
    import gpu
    from gpu_extras.batch import batch_for_shader

    from ..pictures import false_colour

    found, region = _shown[0], bpy.context.region
    size = bpy.context.preferences.system.ui_scale or 1.0
    tools = next((r.width for r in bpy.context.area.regions if r.type == "TOOLS"), 0)
    left = (tools if tools > 1 else 0) + 20.0 * size
    right, low = left + 18.0 * size, 40.0 * size
    high = low + min(260.0 * size, max(region.height - low - 140.0 * size, 60.0))
    steps = 64
    places, colors = [], []
    for k in range(steps + 1):
        y = low + (high - low) * k / steps
        color = (*false_colour.colours(k / steps), 1.0)
        places += [(left, y), (right, y)]
        colors += [color, color]
    shader = gpu.shader.from_builtin("SMOOTH_COLOR")
    batch_for_shader(shader, "TRI_STRIP", {"pos": places, "color": colors}).draw(shader)
    blf.size(0, 11.0 * size)
    blf.enable(0, blf.SHADOW)
    blf.shadow(0, 3, 0.0, 0.0, 0.0, 1.0)
    lines = [(found.drawing.title(found.quantity), left, high + 14.0 * size)]
    if found.changed:
        lines.append(("The scene has changed: show it again", left, low - 18.0 * size))
    last = -100.0
    for level in found.scale.levels:
        y = low + (high - low) * float(found.scale.place(level))
        if y - last > 15.0 * size:
            lines.append((false_colour.text(level), right + 6.0 * size, y - 4.0 * size))
            last = y
    for text, x, y in lines:
        blf.position(0, x, y, 0)
        blf.color(0, 1.0, 1.0, 1.0, 1.0)
        blf.draw(0, text)
    blf.disable(0, blf.SHADOW)


class SKYLIGHT_OT_false_color(operator.Long, bpy.types.Operator):
    """Show how much light falls on surfaces, in colors, over the 3D views. The file does not \
change. After a change of the scene, show it again"""

    bl_idname = "skylight.false_color"
    bl_label = "Show False Color"
    bl_options = {"REGISTER"}  # nothing of the file changes
    doing = "Measuring"

    quantity: bpy.props.EnumProperty(
        name="Quantity", description="Amount of light to show", items=items(QUANTITIES)
    )

    @classmethod
    def disabled_reason(cls, context):
        return operator.no_sky(context)

    def work(self, context):
        """Measure all surfaces of the scene."""
        from ..scene import use_cases

        settings = properties.settings_of(context.scene.world)
        return use_cases.light_on_surfaces(context.scene, settings)

    def finish(self, context, done):
        """Show what was measured."""
        if done is None:
            return [("WARNING", "Stopped: nothing is shown")]
        show(done, self.quantity)
        return [("INFO", f"{QUANTITIES[self.quantity].label}: up to {_shown[0].scale.high:g}")]


class SKYLIGHT_OT_hide_false_color(operator.Thin, bpy.types.Operator):
    """Hide the false colors"""

    bl_idname = "skylight.hide_false_color"
    bl_label = "Hide False Color"
    bl_options = {"REGISTER"}

    @classmethod
    def disabled_reason(cls, context):
        return "" if _shown else "No false colors are shown"

    def run(self, context):
        hide()
        return []


def draw(layout: bpy.types.UILayout) -> None:
    """The row that shows false colors, and hides them."""
    row = layout.row(align=True)
    text = translated(QUANTITIES[shown()].label if shown() in QUANTITIES else "Show False Color")
    row.operator_menu_enum(
        "skylight.false_color", "quantity", text=text, icon="IMAGE_RGB_ALPHA", translate=False
    )
    if _shown:
        row.operator("skylight.hide_false_color", text="", icon="X")
    layout.operator_menu_enum("skylight.sunlight", "show", icon="LIGHT_SUN")


CLASSES = (SKYLIGHT_OT_false_color, SKYLIGHT_OT_hide_false_color)
