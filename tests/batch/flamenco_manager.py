"""What of Flamenco's Manager a job type meets: globals, and jobs and tasks that it fills.

As of Flamenco 3.3 to 3.9 (`internal/manager/job_compilers`): strict mode; a job takes a *copy* of a
task as it is when it is added; a task needs a name and a type; a command has a number of steps from
3.8 on, and the function that makes one a third parameter; the Manager replaces `{variables}` in a
command's strings when it hands a task to a worker.
"""

from __future__ import annotations

import json
import shlex
from pathlib import Path

import quickjs

from spectral_skylight.addon.batch.task import scripts_hash

SCRIPT = Path(__file__).parents[2] / "addon" / "batch" / "flamenco" / "spectral_skylight.js"

NEWEST = (3, 9)

AUTHOR = """
function print() {}
const author = {
    uuids: 0,
    Task(name, type) {
        if (!name.trim()) throw new Error("author.Task(name, type): name is required");
        if (!type.trim()) throw new Error("author.Task(name, type): type is required");
        return {
            uuid: String(author.uuids++), name: name.trim(), type: type.trim(), commands: [],
            dependencies: [],
            addCommand(command) { this.commands.push(command); },
            addDependency(task) { this.dependencies.push(task.uuid); },
        };
    },
    Command: steps ? function (name, parameters, totalStepCount) {
        return command(name, parameters, totalStepCount || 0);
    } : function (name, parameters) { return command(name, parameters, 0); },
};
function command(name, parameters, totalStepCount) {
    return { name, parameters: JSON.parse(JSON.stringify(parameters)), totalStepCount };
}
function compiled(settings) {
    const job = {
        settings, tasks: [],
        addTask(task) { this.tasks.push(JSON.parse(JSON.stringify(task))); },
    };
    compileJob(job);
    return JSON.stringify(job.tasks);
}
"""


def _manager(version: tuple[int, int]) -> quickjs.Context:
    context = quickjs.Context()
    context.set_time_limit(10)
    context.eval(f'"use strict"; const steps = {json.dumps(version >= (3, 8))};' + AUTHOR)
    context.eval('"use strict";' + SCRIPT.read_text(encoding="utf-8"))
    return context


def job_type(version: tuple[int, int] = NEWEST) -> dict:
    """The script's JOB_TYPE."""
    return json.loads(_manager(version).eval("JSON.stringify(JOB_TYPE)"))


def compile_job(settings: dict, version: tuple[int, int] = NEWEST) -> list[dict]:
    """The tasks of a job; raises quickjs.JSException where the script refuses it.

    Its scripts are those of this program, where ``settings`` do not say which.
    """
    settings = {"scripts": scripts_hash(), **settings}
    return json.loads(_manager(version).eval(f"compiled({json.dumps(settings)})"))


def renders(tasks: list[dict]) -> list[dict]:
    """The tasks that render: no other waits for none."""
    return [task for task in tasks if not task["dependencies"]]


def command_line(task: dict, variables: dict[str, str]) -> list[str]:
    """The one command of a task as a worker runs it."""
    (command,) = task["commands"]
    return line_of(command, variables)


def line_of(command: dict, variables: dict[str, str]) -> list[str]:
    """`exec`, or `blender-render`: exe, exeArgs, argsBefore, the file unless empty, args."""
    given = command["parameters"]
    if command["name"] == "exec":
        line = [given["exe"], *given["args"]]
    else:
        assert command["name"] == "blender-render"
        before = [*shlex.split(given["exeArgs"]), *given["argsBefore"]]
        blendfile = [given["blendfile"]] if given["blendfile"] else []
        line = [given["exe"], *before, *blendfile, *given["args"]]
    for name, value in variables.items():
        line = [part.replace(f"{{{name}}}", value) for part in line]
    return line
