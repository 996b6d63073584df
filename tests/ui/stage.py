"""Stage props: a small sky, a CSV of two materials, and a layout that records what is drawn."""

from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from spectral_skylight.addon.scene.materials import spectral_material
from spectral_skylight.addon.sky.lat_long import directions
from spectral_skylight.addon.sky.panorama import write_panorama

BRICK = "wavelength_nm,brick,moss\n" + "".join(
    f"{nm},{0.05 + 0.4 * (nm > 580):.3f},{0.1 + 0.2 * (500 < nm < 580):.3f}\n"
    for nm in range(380, 781, 10)
)


def write_sky(path, turquoise=1.0, sun=3000.0):
    """A blue gradient with a sun, 256 x 128."""
    d = directions(128, 256)
    rgb = (0.2 + 0.8 * np.clip(d[..., 2:], 0, 1)) * [0.35, 0.45 * turquoise, 0.68 * turquoise]
    if sun:
        rgb[40, 80] = np.array([1.2, 1.0, 0.78]) * sun  # as sun and sky are coloured at 33°
    write_panorama(path, rgb.astype(np.float32))
    return path


def select(*names):
    """Select the objects of these names alone; the first becomes active."""
    objects = bpy.context.view_layer.objects
    for obj in objects:
        obj.select_set(obj.name in names)
    objects.active = objects.get(names[0]) if names else None


def material(name="Wall"):
    return bpy.data.materials[name]


def given(name="Wall"):
    managed = spectral_material.managed(material(name))
    return managed and managed.record.reflectance


def matrix(name="Wall"):
    return np.array(spectral_material.managed(material(name)).matrix)


def links(name="Wall"):
    """Every link of a material's tree, by names."""
    return sorted(
        (link.from_node.name, link.from_socket.name, link.to_node.name, link.to_socket.name)
        for link in material(name).node_tree.links
    )


def state():
    """What of the file an operator that fails must not have touched."""
    return (
        bpy.context.scene.world,
        [(m.name, given(m.name), m.skylight.filepath, links(m.name)) for m in bpy.data.materials],
        sorted(tree.name for tree in bpy.data.node_groups),
        sorted(world.name for world in bpy.data.worlds),
    )


def error_of(operator, **properties):
    """The one line that an operator which must fail reports; checks that nothing changed."""
    before = state()
    with pytest.raises(RuntimeError) as caught:
        operator(**properties)
    assert state() == before
    message = str(caught.value).strip()
    assert "\n" not in message
    assert message.startswith("Error: ")
    return message


class Recorder:
    """A layout that notes what is drawn into it, sub-layouts included."""

    def __init__(self, drawn=None):
        self.__dict__["drawn"] = [] if drawn is None else drawn

    def __setattr__(self, name, value):  # use_property_split and the like
        pass

    def __getattr__(self, name):
        if name in ("row", "column", "box", "split", "grid_flow"):
            return lambda **options: Recorder(self.drawn)
        if name == "panel":
            return lambda *names, **options: (Recorder(self.drawn), Recorder(self.drawn))

        def draw(*arguments, **options):
            self.drawn.append((name, arguments, options))
            return SimpleNamespace()

        return draw

    @property
    def text(self):
        """All labels, as one running text."""
        return " ".join(options["text"] for kind, _, options in self.drawn if kind == "label")

    @property
    def operators(self):
        """Identifiers of all buttons."""
        return [arguments[0] for kind, arguments, _ in self.drawn if kind == "operator"]

    @property
    def properties(self):
        """Names of all properties."""
        return [arguments[1] for kind, arguments, _ in self.drawn if kind.startswith("prop")]

    def __str__(self):
        return "\n".join(
            f"  {kind:12}"
            + " ".join(str(a) for a in (*arguments, options) if isinstance(a, (str, dict)))
            for kind, arguments, options in self.drawn
        )


def drawn(panel):
    """What a panel draws, with no window."""
    recorder = Recorder()
    panel.draw(SimpleNamespace(layout=recorder), bpy.context)
    return recorder
