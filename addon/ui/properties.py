"""What a person chooses of a World's light, kept with the World in the blend file."""

# No postponed annotations here and in operators: Blender reads its properties from them.
# mypy: disable-error-code="valid-type"

import math
from dataclasses import replace

import bpy

from ..choices import GROUNDS, OCCLUSIONS, SIMPLEST, items, offered_bases
from .material_properties import SkylightLamp, SkylightReflectance

START = {"basis": SIMPLEST, "tolerance": 0.5, "gloss": True}
"""What the panel starts with; scripts and the command line choose for themselves."""


def _stored(world):
    """A World's settings; those that the panel starts with where it has none yet."""
    from ..scene.world import settings

    return settings.stored(world) or settings.Settings(**START)


def _store(world, **values) -> None:
    from ..scene.world import settings

    if {"occlusion", "tolerance"} & set(values):
        values["least"] = None  # what light is enough is not known any more
    settings.store(world, replace(_stored(world), **values))


def _stored_enum(key: str, items: tuple, **described: str):
    """An enum that lies with the World's settings; its first item where they have another value."""
    names = [item[0] for item in items]

    def get(self) -> int:
        name = getattr(_stored(self.id_data), key)
        return names.index(name) if name in names else 0

    def put(self, value: int) -> None:
        _store(self.id_data, **{key: names[value]})

    return bpy.props.EnumProperty(items=items, get=get, set=put, **described)


def _stored_bool(key: str, **described: str):
    """A switch that lies with the World's settings."""
    return bpy.props.BoolProperty(
        get=lambda self: getattr(_stored(self.id_data), key),
        set=lambda self, value: _store(self.id_data, **{key: value}),
        **described,
    )


def _socket(world, name: str):
    """The socket of a World's node that turns its sky, or makes it brighter; None without it."""
    from ..scene.world import hdri

    sky = hdri.sky_of(world)
    node = sky.mapping if name == "Rotation" else sky.background
    return None if node is None else world.node_tree.nodes[node].inputs[name]


def _turned(world) -> float:
    """The sign of an angle in a World's Mapping: one that is a texture's turns the other way."""
    from ..scene.world import hdri

    return 1.0 if hdri.sky_of(world).inverse else -1.0


def _rotation(self) -> float:
    socket = _socket(self.id_data, "Rotation")
    return 0.0 if socket is None else _turned(self.id_data) * socket.default_value[2]


def _rotate(self, value: float) -> None:
    if (socket := _socket(self.id_data, "Rotation")) is not None:
        socket.default_value[2] = _turned(self.id_data) * value


def _exposure(self) -> float:
    socket = _socket(self.id_data, "Strength")
    return 0.0 if socket is None else math.log2(max(socket.default_value, 2.0**-20))


def _expose(self, value: float) -> None:
    if (socket := _socket(self.id_data, "Strength")) is not None:
        socket.default_value = 2.0**value


class SkylightNumbers(bpy.types.PropertyGroup):
    """What the numbers of a World's HDRI mean, as `world.skylight`.

    They lie with the World as plain data (`scene.settings`), where scripts and the command line
    leave theirs: the panel shows what the materials were made with, whoever made them.
    """

    rotation: bpy.props.FloatProperty(
        name="Rotation",
        description="Turn of the sky about the vertical, counterclockwise from above",
        subtype="ANGLE",
        step=100,
        get=_rotation,
        set=_rotate,
    )
    exposure: bpy.props.FloatProperty(
        name="Exposure",
        description="Brightness of the sky, in stops. It is the Strength of the World's Background",
        soft_min=-10.0,
        soft_max=10.0,
        precision=2,
        get=_exposure,
        set=_expose,
    )
    basis: _stored_enum(
        "basis",
        items(offered_bases()),
        name="Basis",
        description="Spectra that skylight is mixed from",
    )
    sun: _stored_bool(
        "sun",
        name="Sun",
        description="The HDRI's sun shines on spectral materials, as a lamp with its own spectrum. "
        "Adds one shading pass per pixel",
    )
    ground: _stored_enum(
        "ground", items(GROUNDS), name="Ground", description="Source of the light from below"
    )
    occlusion: _stored_enum(
        "occlusion",
        items(OCCLUSIONS),
        name="Sky Shadows",
        description="How geometry that hides the sky darkens materials",
    )
    bounce: _stored_bool(
        "bounce",
        name="Bounce",
        description="Has no effect: baked sky shadows always include reflected light",
    )
    gloss: _stored_bool(
        "gloss",
        name="Keep Gloss",
        description="Keep the specular and metallic layers of each material over its measured base",
    )
    level_lux: bpy.props.FloatProperty(
        name="Lux on the Level",
        description="Illuminance of sky and sun on the level in the open, as you have measured it. "
        "0: what the sky's file says, or relative numbers",
        min=0.0,
        max=1e6,
        precision=0,
        get=lambda self: _level_lux(self.id_data),
        set=lambda self, value: _keep_level_lux(self.id_data, value),
    )
    tolerance: bpy.props.FloatProperty(
        name="Tolerance",
        description="Largest acceptable color error (CIEDE2000 ΔE). 1 is just noticeable. Each "
        "material uses the simplest model within it. 0: always use the full model",
        min=0.0,
        max=10.0,
        precision=2,
        get=lambda self: _stored(self.id_data).tolerance or 0.0,
        set=lambda self, value: _store(self.id_data, tolerance=value or None),
    )
    camera: bpy.props.StringProperty(
        name="Camera",
        description="Only for an HDRI in raw camera RGB: the name of the camera (such as Nikon "
        "5100) or a CSV with its R, G, B sensitivities. Load the sky again after a change",
        get=lambda self: _stored(self.id_data).camera or "",
        set=lambda self, value: _store(self.id_data, camera=value.strip() or None),
    )
    sun_told: bpy.props.BoolProperty(
        name="Sun Elevation",
        description="Set the elevation of a sun that the HDRI does not show. The sky of a low sun "
        "has a different spectrum. Daytime is assumed otherwise",
        get=lambda self: _stored(self.id_data).sun_elevation is not None,
        set=lambda self, value: _store(self.id_data, sun_elevation=30.0 if value else None),
    )
    sun_elevation: bpy.props.FloatProperty(
        name="Elevation",
        description="Elevation of the sun above the horizon in degrees. Negative after sunset",
        min=-6.0,
        max=90.0,
        get=lambda self: _stored(self.id_data).sun_elevation or 0.0,
        set=lambda self, value: _store(self.id_data, sun_elevation=float(value)),
    )
    white_balanced: bpy.props.BoolProperty(
        name="White-Balanced",
        description="The HDRI is white-balanced. Spectral materials undo the white balance, or "
        "they lose nearly all of their accuracy",
        get=lambda self: _stored(self.id_data).white is not None,
        set=lambda self, value: _store(self.id_data, white=(1.0, 1.0, 1.0) if value else None),
    )
    white: bpy.props.FloatVectorProperty(
        name="Neutral Light",
        description="RGB of neutral light before the HDRI was white-balanced",
        size=3,
        min=0.0,
        get=lambda self: _stored(self.id_data).white or (1.0, 1.0, 1.0),
        set=lambda self, value: _store(self.id_data, white=tuple(value)),
    )


def _level_lux(world) -> float:
    from ..scene.meter import calibration

    return calibration.kept_lux(world) or 0.0


def _keep_level_lux(world, value: float) -> None:
    from ..scene.meter import calibration

    calibration.keep_lux(world, value)


def settings_of(world: bpy.types.World):
    """The `scene.world.settings.Settings` that a World's panel shows."""
    found = _stored(world)
    if found.camera is not None and found.camera.startswith("//"):
        path = bpy.path.abspath(found.camera, library=world.library)
        return replace(found, camera=path)
    return found


CLASSES = (SkylightReflectance, SkylightNumbers, SkylightLamp)


def attach() -> None:
    """Give materials and Worlds their properties."""
    bpy.types.Material.skylight = bpy.props.PointerProperty(type=SkylightReflectance)
    bpy.types.World.skylight = bpy.props.PointerProperty(type=SkylightNumbers)
    bpy.types.Light.skylight = bpy.props.PointerProperty(type=SkylightLamp)


def detach() -> None:
    """Take the properties off again; what they hold stays in the file."""
    del bpy.types.Material.skylight
    del bpy.types.World.skylight
    del bpy.types.Light.skylight
