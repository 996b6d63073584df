"""What bakes were before work that bakes anew, so that whoever ends it has them back."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ....node_groups import modifiers
from . import scene_bake, session, shelf, storage


class KeptBakes:
    """The bakes of a file as they are now; either `give_back` or `let_go` ends it."""

    def __init__(self) -> None:
        self._shown: dict[str, tuple[bpy.types.NodeTree, dict[str, Any]]] = {}
        self._values: list[tuple[bpy.types.Object, dict[str, NDArray[np.float32]]]] = []
        for obj in scene_bake.baked():
            modifier, bake = storage.modifier_of(obj), storage.bake_of(obj)
            assert modifier is not None and bake is not None  # which is what `baked` asks for
            inputs = {name: modifiers.get_input(modifier, name) for name in shelf.INPUTS}
            self._shown[obj.name] = modifier.node_group, inputs
            there = [name for name in storage.LIGHTS if name in bake.data.attributes]
            self._values.append(
                (bake, {name: storage.read_attribute(bake, name) for name in there})
            )
            bake.use_fake_user = True  # or it would leave with the new one

    def give_back(self) -> None:
        """Let all objects show the bakes that they had, with the light that these had."""
        session.forget()
        new = [obj for obj in scene_bake.baked() if obj.name not in self._shown]
        scene_bake.remove(new)
        gone = []
        for obj in scene_bake.baked():
            modifier = storage.modifier_of(obj)
            assert modifier is not None
            tree, inputs = self._shown[obj.name]
            gone.append(modifiers.get_input(modifier, "Bake"))
            modifier.node_group = tree
            modifiers.set_inputs(modifier, **inputs)
        for bake, attributes in self._values:
            if shelf.is_there(bake):
                for name, values in attributes.items():
                    storage.write_attribute(bake, name, values)
                storage.tell(bake)
        self.let_go()
        storage.discard(gone)

    def let_go(self) -> None:
        """Let bakes leave that nothing shows any more."""
        there = [bake for bake, _ in self._values if shelf.is_there(bake)]
        for bake in there:
            bake.use_fake_user = False
        storage.discard(there)
        self._values = []
