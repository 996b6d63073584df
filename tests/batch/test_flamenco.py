"""The job type for Flamenco: run in a JavaScript engine, as the Manager does."""

import subprocess
import sys

import pytest
import quickjs

from spectral_skylight.addon.batch.dispatch import chunks
from spectral_skylight.addon.batch.flamenco.submit import picture_ranges, task_name
from spectral_skylight.addon.batch.task import SCRIPTS, Task, copy_scripts
from spectral_skylight.tests.batch import flamenco_manager as manager
from spectral_skylight.tests.benchmarks.virtual_farm import Picture

PLAN = "/farm/house/plan.jsonl"


def pictures(task):
    """The range of pictures that a task's command renders."""
    line = manager.command_line(task, {})
    first = int(line[line.index("--first") + 1])
    return range(first, first + int(line[line.index("--count") + 1]))


def test_the_settings_are_such_as_the_manager_knows():
    """`AvailableJobSetting` of Flamenco's OpenAPI description."""
    kind = manager.job_type()
    assert kind["label"]
    keys = {"key", "type", "subtype", "description", "default", "eval", "visible", "required"}
    for setting in kind["settings"]:
        assert setting.keys() <= keys
        assert setting["type"] in ("string", "int32", "float", "bool")
        assert setting.get("subtype", "file_path") in ("file_path", "dir_path", "file_name")
        assert setting.get("visible", "web") in ("visible", "hidden", "submission", "web")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("0-39", [range(40)]),
        ("7", [range(7, 8)]),
        (" 0 - 4 / 2 , 9", [range(0, 2), range(2, 4), range(4, 5), range(9, 10)]),
        ("0-11/12,12-35/12", [range(0, 12), range(12, 24), range(24, 36)]),
    ],
)
def test_each_range_is_a_task(text, expected):
    *tasks, last = manager.compile_job({"plan": PLAN, "pictures": text})
    assert [pictures(task) for task in tasks] == expected
    assert {task["type"] for task in tasks} == {"blender"}
    assert len({task["name"] for task in tasks}) == len(tasks)
    assert not any(task["dependencies"] for task in tasks)
    lines = [manager.line_of(command, {}) for command in last["commands"]]
    parts = 2 if text.endswith(", 9") else 1
    assert [line[-1] for line in lines] == parts * ["--missing"] + parts * ["--check"]
    places = [[int(line[line.index(at) + 1]) for at in ("--first", "--count")] for line in lines]
    assert [n for first, count in places for n in range(first, first + count)] == 2 * [
        n for part in expected for n in part
    ]


def test_the_last_task_renders_what_is_missing_reports_and_checks():
    """The report before the check, whose failure may end the job. Any worker can do all three."""
    job = {"plan": "{shared}/house/plan.jsonl", "pictures": "0-39/10", "report": True}
    *tasks, last = manager.compile_job(job)
    assert last["dependencies"] == [task["uuid"] for task in tasks] and len(tasks) == 4
    assert {task["type"] for task in (*tasks, last)} == {"blender"}
    assert last["name"] == "missing pictures, report, check"
    variables = {"shared": "/farm", "blender": "/opt/blender"}
    missing, report, check = (manager.line_of(each, variables) for each in last["commands"])
    assert missing[-1] == "--missing" and check[-1] == "--check"
    assert report[:3] == ["/opt/blender", "-b", "--factory-startup"]
    assert report[-2:] == ["--", PLAN]
    assert "n.index('report')" in report[-3] and "n.index('render_task')" not in report[-3]
    last = manager.compile_job({**job, "report": False})[-1]
    assert last["name"] == "missing pictures, check" and len(last["commands"]) == 2


@pytest.mark.parametrize(
    ("version", "name", "steps"), [((3, 3), "exec", 0), ((3, 8), "blender-render", 10)]
)
def test_previews_and_progress_from_3_8_on(version, name, steps):
    """Before, Blender is run all the same: `exec` knows no steps and shows nothing."""
    job = {"plan": PLAN, "pictures": "0-39/10", "report": True}
    tasks = manager.compile_job(job, version)
    assert {command["name"] for task in tasks for command in task["commands"]} == {name}
    assert [task["commands"][0]["totalStepCount"] for task in tasks[:4]] == 4 * [steps]
    same = [manager.line_of(t["commands"][0], {}) for t in manager.compile_job(job, (3, 9))]
    assert [manager.line_of(task["commands"][0], {}) for task in tasks] == same


def test_tasks_have_the_names_they_are_given():
    names = "house, noon: Court\nhouse, dusk: Court"
    tasks = manager.compile_job({"plan": PLAN, "pictures": "0-5/2", "names": names})
    told = [task["name"] for task in manager.renders(tasks)]
    assert told == ["house, noon: Court", "house, dusk: Court", "pictures 4-5"]


def one(camera, frame=1, blend="prepared/house_red_noon.12345678.blend"):
    return Task(0, blend, "Scene", camera, frame, "cycles", 1, (8, 8), "pictures/a.exr", "key")


@pytest.mark.parametrize(
    ("chunk", "animated", "said"),
    [
        ([one("Court")], False, "house, red, 21 June noon: Court"),
        ([one("Court"), one("Yard")], False, "house, red, 21 June noon: Court, Yard"),
        ([one(f"V{n}") for n in range(12)], False, "house, red, 21 June noon: V0 to V11"),
        ([one("Court", n) for n in range(3, 9)], True, "house, red, 21 June noon: Court 3-8"),
        ([one("A", 9), one("B", 1)], True, "house, red, 21 June noon: A 9, B 1"),
        ([one("Two\nlines")], False, "house, red, 21 June noon: Two lines"),
    ],
)
def test_a_task_is_named_by_scene_sky_and_cameras(chunk, animated, said):
    record = {"scene": "house", "variant": "red", "sky": "21 June noon"}
    assert task_name(chunk, record, animated) == said
    assert task_name(chunk, None, animated).startswith("house_red_noon: ")


@pytest.mark.parametrize("text", ("", "5-3", "0-9/0", "1,,2", "a-b", "-3", "0-9;8"))
def test_what_is_no_range_is_refused(text):
    with pytest.raises(quickjs.JSException, match="is no range; write A-B or A-B/N"):
        manager.compile_job({"plan": PLAN, "pictures": text})


@pytest.mark.parametrize(
    "plan",
    [
        "/farm/plan.jsonl",
        "/plan.jsonl",
        "{shared}/house/plan.jsonl",
        r"S:\farm\plan.jsonl",
        r"\\nas\farm\plan.jsonl",
        "//nas/farm/plan.jsonl",
        "/farm/Haus am See (2)/plan $&.jsonl",
    ],
)
def test_the_plan_is_given_as_it_is_and_the_code_names_no_path(plan):
    """Python finds the folder; the Manager's variables stand in arguments."""
    (task,) = manager.renders(manager.compile_job({"plan": plan, "pictures": "0"}))
    line = manager.command_line(task, {})
    assert line[line.index("--") + 1] == plan
    code = line[line.index("--python-expr") + 1]
    assert "farm" not in code and not set('{}\n"') & set(code)


def copies(folder):
    folder.mkdir()
    (folder / "plan.jsonl").write_text("")
    copy_scripts(folder)
    return folder / "plan.jsonl"


def run_beside(plan, *more):
    """What Blender would do with a task's line of Python, by Python itself."""
    (task,) = manager.renders(manager.compile_job({"plan": str(plan), "pictures": "0"}))
    line = manager.command_line(task, {})
    code = line[line.index("--python-expr") + 1]
    command = [sys.executable, "-P", "-c", code, *line[line.index("--") :], *more]
    return subprocess.run(command, cwd=plan.parent, capture_output=True, text=True)


def test_scripts_that_were_changed_are_not_run(tmp_path):
    """Nor is anything else that lies there; ours, unchanged, read an empty plan."""
    plan = copies(tmp_path / "out")
    for name in ("argparse", "numpy", "json", "sitecustomize"):
        (plan.parent / f"{name}.py").write_text("open('ran', 'w').close()")
    done = run_beside(plan, "--check")
    assert done.returncode == 0 and "All 0 pictures are there" in done.stdout, done.stderr
    for script in SCRIPTS:
        copy_scripts(plan.parent)
        with (plan.parent / script.name).open("a") as file:
            file.write("\nopen('ran', 'w').close()\n")
        done = run_beside(plan, "--check")
        assert done.returncode == 1 and "scripts beside the plan were changed" in done.stderr
    assert not (plan.parent / "ran").exists()


@pytest.mark.parametrize(
    "scripts", ["", None, "abc render_task", "0" * 64, "0" * 64 + " a';import"]
)
def test_a_job_without_its_scripts_hash_is_refused(scripts):
    with pytest.raises(quickjs.JSException, match="give hash and names"):
        manager.compile_job({"plan": PLAN, "pictures": "0", "scripts": scripts})


@pytest.mark.parametrize("plan", ("plan.jsonl", "../plan.jsonl", "", None))
def test_a_relative_plan_is_refused(plan):
    with pytest.raises(quickjs.JSException, match="is no absolute path"):
        manager.compile_job({"plan": plan, "pictures": "0"})


def test_a_plan_of_100_000_pictures():
    """One job; Flamenco takes more than 1,000 tasks since 3.3."""
    tasks = manager.renders(manager.compile_job({"plan": PLAN, "pictures": "0-99999/12"}))
    assert len(tasks) == 8334


@pytest.mark.parametrize(
    ("blends", "size", "ranges"),
    [
        ("aaaabbbbcccc", 4, "0-11/4"),
        ("aaaabbbbcccc", 2, "0-11/2"),
        ("aaaabbbbcccc", 3, "0-3/3,4-7/3,8-11/3"),
        ("aaabbcccc", 3, "0-4/3,5-8/3"),
        ("a", 12, "0-0/1"),
    ],
)
def test_no_task_opens_two_files(blends, size, ranges):
    """As `dispatch` cuts a plan, `picture_ranges` writes it and the job type reads it."""
    plan = [Picture(number, blend) for number, blend in enumerate(blends)]
    cut = list(chunks(plan, size))
    assert picture_ranges(cut) == ranges
    tasks = manager.renders(manager.compile_job({"plan": PLAN, "pictures": ranges}))
    assert [list(pictures(task)) for task in tasks] == [[p.index for p in part] for part in cut]


def test_tasks_shrink_towards_the_end_of_a_plan():
    plan = [Picture(number, f"{number // 40}") for number in range(1440)]
    cut = list(chunks(plan, 12, len(plan), workers=20))
    ranges = picture_ranges(cut)
    tasks = manager.renders(manager.compile_job({"plan": PLAN, "pictures": ranges}))
    assert [list(pictures(task)) for task in tasks] == [[p.index for p in part] for part in cut]
    assert (len(cut[0]), len(cut[-1])) == (12, 1)
    assert len(ranges) < 1000
