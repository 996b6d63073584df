"""Cycles on the GPU, in a Blender without preferences."""

from types import SimpleNamespace

import pytest

from spectral_skylight.addon.scene.output.render_task import choose_gpu


class Preferences:
    """Cycles' preferences on a machine with the given devices, (kind, name) each."""

    def __init__(self, kinds, devices):
        self._kinds, self._devices, self._kind = kinds, devices, "NONE"
        self.devices = []

    @property
    def compute_device_type(self):
        return self._kind

    @compute_device_type.setter
    def compute_device_type(self, kind):
        if kind not in self._kinds:
            raise TypeError(f'enum "{kind}" not found in {self._kinds}')
        self._kind = kind

    def refresh_devices(self):
        self.devices = [
            SimpleNamespace(type=kind, name=name, use=True)
            for kind, name in self._devices
            if kind in ("CPU", self._kind)
        ]


LINUX, MAC = ("NONE", "CUDA", "OPTIX", "HIP", "ONEAPI"), ("NONE", "METAL")


@pytest.mark.parametrize(
    ("kinds", "devices", "chosen", "used"),
    [
        (LINUX, [("OPTIX", "A"), ("CUDA", "A"), ("CPU", "Xeon")], "OPTIX", ["A"]),
        (LINUX, [("CUDA", "A"), ("CUDA", "B"), ("CPU", "Xeon")], "CUDA", ["A", "B"]),
        (LINUX, [("HIP", "C"), ("CPU", "Ryzen")], "HIP", ["C"]),
        (MAC, [("METAL", "M4"), ("CPU", "M4")], "METAL", ["M4"]),
        (LINUX, [("CPU", "Xeon")], "NONE", []),
    ],
)
def test_the_fastest_kind_that_is_there(kinds, devices, chosen, used):
    preferences = Preferences(kinds, devices)
    assert choose_gpu(preferences) == chosen
    assert [device.name for device in preferences.devices if device.use] == used
    assert choose_gpu(preferences) == chosen


@pytest.mark.blender
def test_blender_itself():
    """Whatever this machine has: a kind with devices in use, or none and the processor."""
    bpy = pytest.importorskip("bpy")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    preferences = bpy.context.preferences.addons["cycles"].preferences
    chosen = choose_gpu(preferences)
    used = {device.type for device in preferences.devices if device.use}
    assert used == ({chosen} if chosen != "NONE" else set())
    bpy.ops.wm.read_factory_settings(use_empty=True)
