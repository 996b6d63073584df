"""The colours that light makes of points, left on objects for shaders to read."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

from ....node_groups import baked_light
from . import storage
from .collected import Collected
from .receivers import filled

Values = list[tuple[str, dict[str, NDArray[np.float32]]]]
"""Names of objects, and what each attribute (p, 4) of their points holds."""


def of(collected: Collected, colours: NDArray[np.float32]) -> Values:
    """What all objects get of the colours (n, 3) of their receivers."""
    told = collected.told
    result: Values = []
    for target in collected.receivers.targets:
        own: dict[str, NDArray[np.float32]] = {}
        for side, name in ((1.0, baked_light.LIGHT), (-1.0, baked_light.BEHIND)):
            points, numbers = target.numbers[side]
            if side < 0 and not target.backs.any():
                continue
            values = np.zeros((len(target.fine.places), 4), np.float32)
            share = np.zeros(len(values))
            values[points, :3], share[points] = colours[numbers], told[numbers]
            values[points, 3] = baked_light.FLAG
            values[len(values) - len(target.fine.twin_of) :, 3] = baked_light.FLAG
            values[:, :3] = filled(target.fine, values[:, :3], share)
            own[name] = values
        result.append((target.name, own))
    return result


def write(values: Values) -> None:
    """Leave on all objects their colours, at once, so that they are of one light."""
    objects = {obj.name: obj for obj in bpy.data.objects if obj.library is None}
    for owner, attributes in values:
        obj = objects[owner]
        bake = storage.bake_of(obj)
        assert bake is not None  # else it is no target
        for name, each in attributes.items():
            storage.write_attribute(bake, name, each)
        storage.tell(bake)
        obj.update_tag()
