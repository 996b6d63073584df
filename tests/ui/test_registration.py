"""Enabling the add-on: it imports nothing heavy, and disabling leaves nothing behind."""

import subprocess
import sys

import bpy
import pytest

import spectral_skylight
from spectral_skylight.addon import registration

pytestmark = pytest.mark.blender

FRESH = """
import os, sys
import bpy
import spectral_skylight
data = {name: len(getattr(bpy.data, name)) for name in ("materials", "worlds", "node_groups")}
spectral_skylight.register()
package = spectral_skylight.__name__ + ".addon"
heavy = [f"{package}.{room}" for room in ("spectra", "sky", "transfer", "scene", "cli")]
found = [name for name in ("colour", "scipy", "OpenEXR", *heavy) if name in sys.modules]
assert not found, found
assert data == {name: len(getattr(bpy.data, name)) for name in data}
print("registered", bpy.ops.skylight.apply.get_rna_type().identifier)
sys.stdout.flush()
os._exit(0)  # bpy before 5.0 can crash on its way out
"""


def left_over():
    """Whatever of ours Blender knows."""
    classes = [cls.__name__ for cls in registration.CLASSES if hasattr(bpy.types, cls.__name__)]
    properties = [
        owner.__name__
        for owner in (bpy.types.Material, bpy.types.World)
        if "skylight" in owner.bl_rna.properties
    ]
    return classes + properties + dir(bpy.ops.skylight)


def test_enabling_imports_no_room_that_computes():
    done = subprocess.run([sys.executable, "-c", FRESH], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "registered SKYLIGHT_OT_apply" in done.stdout


def test_enabling_and_disabling_twice_leaves_nothing():
    assert left_over() == []
    for _ in range(2):
        spectral_skylight.register()
        assert {"SKYLIGHT_PT_main", "Material", "World", "apply"} <= set(left_over())
        spectral_skylight.unregister()
        assert left_over() == []


def test_a_failure_halfway_takes_back_the_first_half(monkeypatch):
    def fail(*arguments):
        raise RuntimeError("no command today")

    monkeypatch.setattr(bpy.utils, "register_cli_command", fail)
    with pytest.raises(RuntimeError, match="no command today"):
        spectral_skylight.register()
    assert left_over() == []


def test_the_command_hands_its_arguments_to_the_command_line(monkeypatch, capsys):
    commands = {}
    monkeypatch.setattr(bpy.utils, "register_cli_command", commands.__setitem__)
    monkeypatch.setattr(bpy.utils, "unregister_cli_command", lambda handle: None)
    spectral_skylight.register()
    spectral_skylight.unregister()
    assert commands["skylight"](["--help"]) == 0
    assert "render" in capsys.readouterr().out
    assert commands["skylight"](["paint"]) == 2  # wrong usage
