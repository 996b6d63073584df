"""A plan is text: in order, in little memory, with names that say what is in a picture."""

import dataclasses
import json

import pytest

from spectral_skylight.addon.batch import plan
from spectral_skylight.addon.batch.file_names import file_names
from spectral_skylight.addon.batch.scenes import SceneFile
from spectral_skylight.addon.batch.study import read_study
from spectral_skylight.addon.batch.task import SCRIPT, task_of
from spectral_skylight.addon.errors import InputError
from spectral_skylight.tests.batch.studies import NOON, write_inputs, write_study


def house(folder, cameras=("North", "South/1", "South:1")):
    return SceneFile(folder / "house.blend", "c", "Scene", cameras, 7, "cycles", (16, 16))


@pytest.fixture
def study(tmp_path):
    (tmp_path / "house.blend").touch()
    skies = [{**NOON, "times": ["09:00", "12:00"]}, "sky.exr"]
    variants = [{"name": "red", "assign": "red.csv"}, {"name": "as built"}]
    return read_study(write_study(write_inputs(tmp_path), skies=skies, variants=variants))


def test_a_plan_is_written_and_read(study, tmp_path):
    path = plan.write_plan(study, (house(tmp_path),), "program")
    header, *lines = path.read_text(encoding="utf-8").splitlines()
    assert json.loads(header)["tasks"] == len(lines) == 3 * 2 * 3
    tasks = list(plan.read_tasks(path))
    assert [task.index for task in tasks] == list(range(18))
    assert tasks == [task_of(line) for line in lines]
    assert list(plan.read_tasks(path, 4, 3)) == tasks[4:7]
    assert len({task.exr for task in tasks}) == len({task.key for task in tasks}) == 18
    assert tasks[1].exr == (
        "pictures/house_red_2025-06-21_0900/house_red_2025-06-21_0900_South-1_0007.exr"
    )
    assert tasks[2].exr.endswith("South-1-2_0007.exr")  # South:1 would be the same file
    assert (path.parent / "render_task.py").read_bytes() == SCRIPT.read_bytes()
    blends = [task.blend for task in tasks]
    assert blends == sorted(blends, key=blends.index) and len(set(blends)) == 6  # together
    again = plan.write_plan(study, (house(tmp_path),), "program")
    assert again.read_text(encoding="utf-8").splitlines() == [header, *lines]


def test_keys_change_with_what_decides_a_picture(study, tmp_path):
    scene = house(tmp_path)
    key = next(plan.tasks(study, (scene,), "program")).key
    changed = [
        (study, dataclasses.replace(scene, content="d"), "program"),
        (study, dataclasses.replace(scene, engine="eevee"), "program"),
        (study, dataclasses.replace(scene, frame=8), "program"),
        (study, scene, "another"),
        (dataclasses.replace(study, samples=2), scene, "program"),
        (dataclasses.replace(study, skies=study.skies[1:]), scene, "program"),
        (dataclasses.replace(study, variants=study.variants[1:]), scene, "program"),
        (dataclasses.replace(study, settings={**study.settings, "sun": False}), scene, "program"),
    ]
    keys = [next(plan.tasks(each, (found,), program)).key for each, found, program in changed]
    assert len({key, *keys}) == 1 + len(changed)


def test_a_plan_that_cannot_be_written_leaves_the_old_one(study, tmp_path, monkeypatch):
    path = plan.write_plan(study, (house(tmp_path),), "program")
    before = path.read_bytes()

    def full(*_):
        raise OSError(28, "No space left on device")  # a full disk: none is to be had here

    monkeypatch.setattr(type(path), "replace", full)
    with pytest.raises(InputError, match=r"plan\.jsonl.*No space"):
        plan.write_plan(study, (house(tmp_path, ("Other",)),), "program")
    assert path.read_bytes() == before
    assert not list(path.parent.glob(".*.part*"))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "not a plan"),
        ("{}", "not a plan"),
        ('{"format": "spectral-skylight plan", "version": 9}', "version 9"),
    ],
)
def test_what_is_no_plan(tmp_path, text, said):
    path = tmp_path / "plan.jsonl"
    path.write_text(text)
    with pytest.raises(InputError, match=said):
        plan.read_header(path)


def test_names_of_files():
    long = "é" * 90
    names = ["a", "A", "b/c", "b:c", "...", "con", long, long + "x", "x\n"]
    found = file_names(names)
    assert found[:6] == ["a", "A-2", "b-c", "b-c-2", "-", "-con"]
    assert len({name.casefold() for name in found}) == len(names)
    assert all(len(name.encode()) <= 102 and not set('<>:"/\\|?*\n') & set(name) for name in found)
