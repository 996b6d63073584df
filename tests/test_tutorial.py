"""The tutorial by its scripts: each step runs, and the panels then say what it promises."""

import bpy
import numpy as np
import pytest

import spectral_skylight
from spectral_skylight.addon.scene.materials import spectral_material
from spectral_skylight.tests.ui import stage
from spectral_skylight.tests.window import tutorial

pytestmark = pytest.mark.blender


@pytest.fixture
def new_file(tmp_path, monkeypatch):
    """A new file as Blender has it, the add-on, and the files that the tutorial names."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    spectral_skylight.register()
    for name, content in tutorial.files().items():
        (tmp_path / name).write_text(content, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    yield
    spectral_skylight.unregister()
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)


def panels():
    """All that the sidebar says."""
    found = [
        cls
        for cls in spectral_skylight.addon.registration.CLASSES
        if issubclass(cls, bpy.types.Panel) and cls.bl_space_type == "VIEW_3D"
    ]
    return " ".join(stage.drawn(cls).text for cls in found)


def test_every_step_of_the_tutorial(new_file):
    steps = tutorial.steps()
    assert [step.title[0] for step in steps] == list("123456")
    matrices = {}
    for step in steps:
        exec(step.script, {"bpy": bpy})
        if step.title[0] in "123":  # further on what was seen before stays
            promised = [text for kind, text in step.actions if kind == "see" and ":" in text]
            assert promised
            assert [text for text in promised if text not in panels()] == []
        found = spectral_material.managed(bpy.data.materials["Material"])
        matrices[step.title[0]] = found and np.array(found.matrix)
    assert matrices["1"] is None and matrices["6"] is None
    assert np.abs(matrices["2"] - matrices["3"]).max() > 0.1
    assert matrices["4"] == pytest.approx(matrices["3"])
    assert matrices["5"] == pytest.approx(matrices["3"])
    assert "No material is spectral yet" in panels()


def test_the_tutorial_names_what_is_there():
    """Every picture exists, and what is pressed is the name of a button, a panel or a choice."""
    pictures = [step.picture for step in tutorial.steps() if step.picture]
    assert len(pictures) >= 3
    for picture in pictures:
        size = (tutorial.FILE.parent / picture).stat().st_size
        assert 5_000 < size < 120_000
