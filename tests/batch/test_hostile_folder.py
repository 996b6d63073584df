"""A folder that somebody sent runs no code, leads nowhere else and costs nobody a file."""

import json
import os
import random
import re
import shutil
from pathlib import Path

import pytest

from spectral_skylight.addon.batch import background, prepare, report, study
from spectral_skylight.addon.batch.plan import read_header, read_tasks
from spectral_skylight.addon.batch.task import SCRIPTS, copy_scripts, task_of
from spectral_skylight.addon.batch.worker import Worker
from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.scene.output import plan_data, render_task
from spectral_skylight.addon.transfer.assignment_table import read_table
from spectral_skylight.tests.batch.studies import write_inputs, write_study

LINE = {
    "index": 0, "blend": "prepared/a.blend", "scene": "Scene", "camera": "C", "frame": 1,
    "engine": "cycles", "samples": 1, "resolution": [8, 8], "exr": "pictures/a/a.exr", "key": "k",
}  # fmt: skip
HEADER = {"format": "spectral-skylight plan", "version": 1, "study": "../study.toml", "tasks": 1}

POSIX = pytest.mark.skipif(os.name == "nt", reason="Windows has no such links")

ELSEWHERE = [
    "../a.exr", "/tmp/a.exr", "pictures/../../a.exr", "pictures//a.exr", "./a.exr", "a.blend",
    "a.exr/", "", "..", r"..\a.exr", "C:a.exr", "C:/a.exr", "a\0.exr", "a\n.exr", "\ud800.exr",
    "a" * 300 + ".exr", 7, None, ["a.exr"], ".exr/../../a.exr", "nul:.exr", "a*.exr",
]  # fmt: skip


def write_plan(folder, *lines, **header):
    folder.mkdir(exist_ok=True)
    content = [json.dumps({**HEADER, **header}), *(json.dumps(line) for line in lines)]
    (folder / "plan.jsonl").write_text("\n".join(content) + "\n")
    return folder / "plan.jsonl"


@pytest.mark.parametrize("name", ELSEWHERE)
def test_a_picture_or_scene_elsewhere_is_no_task(tmp_path, name):
    blend = name.replace(".exr", ".blend") if isinstance(name, str) and ".exr" in name else name
    for wrong in ({**LINE, "exr": name}, {**LINE, "blend": f"{blend}" if name == "" else blend}):
        if wrong.get("blend") == "a.blend":
            continue  # that one is where it should be
        with pytest.raises(ValueError):
            task_of(json.dumps(wrong))
        with pytest.raises(InputError, match=r"line 2: is not a task") as caught:
            list(read_tasks(write_plan(tmp_path / "out", wrong)))
        assert "\n" not in str(caught.value)
        pytest.importorskip("bpy", reason="only a Blender performs tasks")
        answer = render_task.perform(wrong, tmp_path / "out")
        assert answer["status"] == "failed" and "no path of a" in answer["error"]
    assert not list(tmp_path.rglob("*.exr"))


@pytest.mark.parametrize(
    "change",
    [
        {"index": -1}, {"index": True}, {"index": "0"}, {"frame": 1.5}, {"frame": 1 << 40},
        {"samples": 0}, {"samples": "1"}, {"engine": "POVRAY"}, {"engine": []}, {"key": None},
        {"resolution": [8]}, {"resolution": [8, 0]}, {"resolution": 8}, {"resolution": [1e9, 8]},
        {"resolution": ["8", "8"]}, {"scene": 1}, {"camera": {}}, {"more": 1},
    ],
)  # fmt: skip
def test_values_that_no_picture_has_are_no_task(change):
    assert task_of(json.dumps(LINE)).index == 0
    with pytest.raises(ValueError):
        task_of(json.dumps({**LINE, **change}))


@pytest.mark.parametrize("text", ["", "{}", "[]", "null", "7", "[" * 99999, "\x00", '{"index": 0}'])
def test_lines_that_are_no_task(tmp_path, text):
    path = write_plan(tmp_path / "out")
    with path.open("a") as file:
        file.write(text + "\n")
    with pytest.raises(InputError, match="line 2"):
        list(read_tasks(path))
    path.write_bytes(path.read_bytes() + b"\xff\xfe{}\n")
    with pytest.raises(InputError, match="line 2"):
        list(read_tasks(path))


@pytest.mark.parametrize("wrong", [{"tasks": "9"}, {"tasks": -1}, {"study": 7}, {"version": "1"}])
def test_headers_that_are_no_plan_s(tmp_path, wrong):
    with pytest.raises(InputError):
        read_header(write_plan(tmp_path / "out", **wrong))


@POSIX
@pytest.mark.parametrize(
    "name", ["report.html", "status.json", "results.jsonl", "pictures", ".lock"]
)
def test_a_link_out_of_the_folder_is_not_followed(tmp_path, name):
    path = write_plan(tmp_path / "out", LINE)
    target = tmp_path / "mine"
    target.write_text("mine")
    (path.parent / name).symlink_to(target)
    with pytest.raises(InputError, match=re.escape(f"its {name} is a link")):
        read_header(path)
    with pytest.raises(InputError, match=re.escape(f"its {name} is a link")):
        study.folder_of(write_study(tmp_path))
    assert target.read_text() == "mine"


@POSIX
def test_what_would_be_read_for_ever_is_not_opened(tmp_path):
    """Pipes where a study, a table, results, a record or a picture should be."""
    path = write_plan(tmp_path / "out", LINE)
    for name in ("prepared/a.json", "pictures/a/a.exr", "prepared/a.blend"):
        (path.parent / name).parent.mkdir(parents=True, exist_ok=True)
        os.mkfifo(path.parent / name)
    assert report.write_report(path)["counts"] == {"missing": 1}
    for read in (study.read_study, read_table):
        os.mkfifo(pipe := tmp_path / read.__name__)
        with pytest.raises(InputError, match="not a regular file"):
            read(pipe)
    os.mkfifo(path.parent / "results.jsonl")
    with pytest.raises(InputError, match="its results.jsonl is no regular file"):
        read_header(path)


@POSIX
def test_a_link_below_the_folder_is_not_followed(tmp_path):
    pytest.importorskip("bpy", reason="only a Blender performs tasks")
    out = write_plan(tmp_path / "out", LINE).parent
    (tmp_path / "mine").mkdir()
    (out / "pictures").mkdir()
    (out / "pictures" / "a").symlink_to(tmp_path / "mine")
    assert "is a link" in render_task.perform(LINE, out)["error"]
    (out / "pictures" / "a").unlink()
    (out / "pictures" / "a").mkdir()
    (out / "pictures" / "a" / "a.png").symlink_to(tmp_path / "mine" / "a.png")
    assert "is a link" in render_task.perform(LINE, out)["error"]
    assert not list((tmp_path / "mine").iterdir())


def test_what_lies_beside_a_plan_is_not_run(tmp_path):
    """Neither a script of our names nor a module of Python's; by a worker of this machine."""
    pytest.importorskip("bpy", reason="only a Blender performs tasks")
    out = write_plan(tmp_path / "out", LINE).parent
    evil = f"open({str(tmp_path / 'ran')!r}, 'w').close()\n"
    modules = ("argparse", "json", "numpy", "bpy", "queue", "sitecustomize", "usercustomize")
    for name in (*(script.stem for script in SCRIPTS), *modules):
        (out / f"{name}.py").write_text(evil)
    worker = Worker(out)
    before, folder = Path.cwd(), Path(worker.command[-7]).parent
    try:
        os.chdir(out)
        answer = worker.render(task_of(json.dumps(LINE)))
    finally:
        os.chdir(before)
        worker.close()
    assert answer["status"] == "failed" and "a.blend is missing" in answer["error"]
    assert not (tmp_path / "ran").exists() and not folder.exists()


def test_another_study_s_folder_and_a_person_s_files_are_refused(tmp_path):
    (tmp_path / "house.blend").touch()
    first = write_study(write_inputs(tmp_path))
    out = study.read_study(first).out
    write_plan(out, study="../study.toml")
    second = shutil.copy(first, tmp_path / "second.toml")
    with pytest.raises(InputError, match=r"out: belongs to the study .*study.toml; choose another"):
        study.read_study(second)
    assert study.read_study(first).out == out
    first.write_text(first.read_text().replace('"out"', '"elsewhere"'))
    assert study.read_study(second).out == out  # the first writes elsewhere now
    first.unlink()
    assert study.read_study(second).out == out
    for name in ("report.html", "results.jsonl", "status.json", "report.py", "duration.py"):
        (out / "plan.jsonl").unlink(missing_ok=True)
        (out / name).write_text("mine")
        with pytest.raises(InputError, match=rf"its {name} is of no study"):
            study.read_study(second)
        (out / name).unlink()
    (out / "status.json").write_text('{"state": "preparing"}')  # as a killed run leaves it
    copy_scripts(out)
    assert study.read_study(second).out == out
    (out / "plan.jsonl").write_text("mine")
    with pytest.raises(InputError, match="is not a plan and would be written over"):
        study.read_study(second)


@pytest.mark.parametrize(
    ("text", "is_read"),
    [
        ('{"state": "rendering", "line": "1", "done": 1, "total": 2}', True),
        ("[]", False),
        ("[" * 99999, False),
        ('{"state": 7, "line": "x"}', False),
        ('{"state": "done", "line": "x", "done": "9"}', False),
    ],
)
def test_a_status_that_somebody_wrote_is_none(tmp_path, text, is_read):
    (tmp_path / "status.json").write_text(text)
    assert bool(background._read(tmp_path / "status.json")) is is_read


def test_only_what_a_record_of_ours_names_is_deleted(tmp_path):
    folder = tmp_path / "prepared"
    folder.mkdir()
    record = json.dumps({**RECORD, "name": "../../mine"})
    files = {
        "old.12345678.blend": "", "old.12345678.json": record,
        "mine.blend": "", "notes.json": "{}", "mine.json": json.dumps({"name": "mine"}),
        "deep.json": "[" * 99999, "deep.blend": "", "sky.exr": "",
    }  # fmt: skip
    for name, content in files.items():
        (folder / name).write_text(content)
    (tmp_path / "mine.blend").touch()
    prepare._tidy(tmp_path, [])
    left = {path.name for path in folder.iterdir()}
    assert left == files.keys() - {"old.12345678.blend", "old.12345678.json"}
    assert (tmp_path / "mine.blend").exists()


RECORD = {
    "format": plan_data.RECORD, "name": "a", "scene": "h", "sky": "s", "variant": "v",
    "sun": [10.0, 20.0], "notes": ["n"], "elsewhere": [], "blender": "5.2",
    "materials": [{"material": "W", "reflectance": "r", "swatch": "rgb(1 2 3)", "line": "l",
                   "matrix_delta_E": 0.1, "rgb_delta_E": None, "out_of_gamut": False}],
}  # fmt: skip
ANSWERS = [
    {"key": "k", "status": "failed", "error": "x: no", "seconds": 1.0},
    {"key": "k2", "status": "rendered", "seconds": 2.0},
]
WRONG = [
    None,
    True,
    -1,
    1e999,
    10**400,
    "\ud800",
    "x" * 9999,
    [],
    {},
    [None],
    {"a": 1},
    "</script>",
]


def hostile(content, random):
    """The text of a file with one value, key or byte changed, or its end lost."""
    content = json.loads(json.dumps(content))
    place = content
    while isinstance(place, (dict, list)) and place:
        key = random.choice(list(place) if isinstance(place, dict) else range(len(place)))
        if random.random() < 0.4 or not isinstance(place[key], (dict, list)) or not place[key]:
            if random.random() < 0.2:
                del place[key]
            else:
                place[key] = random.choice(WRONG)
            break
        place = place[key]
    text = json.dumps(content).encode()
    if random.random() < 0.2:
        at = random.randrange(len(text))
        text = text[:at] + bytes([random.randrange(256)]) + text[at + random.randrange(3) :]
    return text[: random.randrange(len(text))] if random.random() < 0.1 else text


@pytest.mark.parametrize("seed", range(12))
def test_whatever_lies_in_a_folder_makes_a_report_or_one_line(tmp_path, seed):
    """Forty mutations of each of plan, results and record together, in twelve folders."""
    generator = random.Random(seed)
    out = write_plan(tmp_path / "out", LINE, {**LINE, "index": 1, "key": "k2"}).parent
    (out / "prepared").mkdir()
    (out / "prepared" / "a.blend").touch()
    made = 0
    for _ in range(40):
        header, one, answer, record = (
            hostile(each, generator) if generator.random() < 0.4 else json.dumps(each).encode()
            for each in (HEADER, LINE, generator.choice(ANSWERS), RECORD)
        )
        (out / "plan.jsonl").write_bytes(header + b"\n" + one + b"\n")
        (out / "results.jsonl").write_bytes(answer + b"\n" + answer)
        (out / "prepared" / "a.json").write_bytes(record)
        try:
            report.write_report(out / "plan.jsonl")
        except (ValueError, OSError) as error:
            assert "\n" not in str(error)
            continue
        made += 1
        page = (out / "report.html").read_text(encoding="utf-8")
        assert page.count("</script>") == 1  # nothing of ours lets a text out of its place
        json.loads((out / "report.json").read_text(encoding="utf-8"))
    assert made > 4


def test_a_color_that_is_none_does_not_reach_the_page(tmp_path):
    (tmp_path / "a.json").write_text(json.dumps(RECORD))
    assert plan_data.record(tmp_path / "a.json")["sky"] == "s"
    for swatch in ("url(//x)", "red", "rgb(1 2 3);x:y", 7):
        wrong = {**RECORD, "materials": [{**RECORD["materials"][0], "swatch": swatch}]}
        (tmp_path / "a.json").write_text(json.dumps(wrong))
        with pytest.raises(ValueError, match="materials"):
            plan_data.record(tmp_path / "a.json")
