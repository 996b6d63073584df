"""The job type for Flamenco: run in a JavaScript engine, as the Manager does."""

import pytest
import quickjs

from spectral_skylight.addon.batch.dispatch import chunks
from spectral_skylight.addon.batch.flamenco.submit import picture_ranges
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
    tasks = manager.compile_job({"plan": PLAN, "pictures": text})
    assert [pictures(task) for task in tasks] == expected
    assert {task["type"] for task in tasks} == {"blender"}
    assert len({task["name"] for task in tasks}) == len(tasks)
    assert not any(task["dependencies"] for task in tasks)


def test_the_report_comes_last():
    job = {"plan": "{shared}/house/plan.jsonl", "pictures": "0-39/10", "report": True}
    *tasks, last = manager.compile_job(job)
    assert last["dependencies"] == [task["uuid"] for task in tasks]
    line = manager.command_line(last, {"shared": "/farm"})
    assert line == ["spectral-skylight", "batch", "report", PLAN]


@pytest.mark.parametrize("text", ("", "5-3", "0-9/0", "1,,2", "a-b", "-3", "0-9;8"))
def test_what_is_no_range_is_refused(text):
    with pytest.raises(quickjs.JSException, match="is no range; write A-B or A-B/N"):
        manager.compile_job({"plan": PLAN, "pictures": text})


@pytest.mark.parametrize(
    ("plan", "script"),
    [
        ("/farm/plan.jsonl", "/farm/render_task.py"),
        ("/plan.jsonl", "/render_task.py"),
        ("{shared}/house/plan.jsonl", "{shared}/house/render_task.py"),
        (r"S:\farm\plan.jsonl", r"S:\farm\render_task.py"),
        (r"\\nas\farm\plan.jsonl", r"\\nas\farm\render_task.py"),
        ("//nas/farm/plan.jsonl", "//nas/farm/render_task.py"),
        ("/farm/Haus am See (2)/plan $&.jsonl", "/farm/Haus am See (2)/render_task.py"),
    ],
)
def test_the_script_lies_beside_the_plan(plan, script):
    (task,) = manager.compile_job({"plan": plan, "pictures": "0"})
    line = manager.command_line(task, {})
    assert line[line.index("-P") + 1] == script
    assert line[line.index("--") + 1] == plan


@pytest.mark.parametrize("plan", ("plan.jsonl", "../plan.jsonl", "", None))
def test_a_relative_plan_is_refused(plan):
    with pytest.raises(quickjs.JSException, match="is no absolute path"):
        manager.compile_job({"plan": plan, "pictures": "0"})


def test_a_plan_of_100_000_pictures():
    """One job; Flamenco takes more than 1,000 tasks since 3.3."""
    tasks = manager.compile_job({"plan": PLAN, "pictures": "0-99999/12"})
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
    tasks = manager.compile_job({"plan": PLAN, "pictures": ranges})
    assert [list(pictures(task)) for task in tasks] == [[p.index for p in part] for part in cut]


def test_tasks_shrink_towards_the_end_of_a_plan():
    plan = [Picture(number, f"{number // 40}") for number in range(1440)]
    cut = list(chunks(plan, 12, len(plan), workers=20))
    ranges = picture_ranges(cut)
    tasks = manager.compile_job({"plan": PLAN, "pictures": ranges})
    assert [list(pictures(task)) for task in tasks] == [[p.index for p in part] for part in cut]
    assert (len(cut[0]), len(cut[-1])) == (12, 1)
    assert len(ranges) < 1000
