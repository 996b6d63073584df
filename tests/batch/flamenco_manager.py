"""What of Flamenco's Manager a job type meets: globals, and jobs and tasks that it fills.

As of Flamenco 3.3 to 3.8 (`internal/manager/job_compilers`): strict mode; a job takes a *copy* of a
task as it is when it is added; a task needs a name and a type; the Manager replaces
`{variables}` in a command's strings when it hands a task to a worker.
"""

from __future__ import annotations

import json
from pathlib import Path

import quickjs

SCRIPT = Path(__file__).parents[2] / "addon" / "batch" / "flamenco" / "spectral_skylight.js"

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
    Command(name, parameters, totalStepCount = 0) {
        return { name, parameters: JSON.parse(JSON.stringify(parameters)), totalStepCount };
    },
};
function compiled(settings) {
    const job = {
        settings, tasks: [],
        addTask(task) { this.tasks.push(JSON.parse(JSON.stringify(task))); },
    };
    compileJob(job);
    return JSON.stringify(job.tasks);
}
"""


def _manager() -> quickjs.Context:
    context = quickjs.Context()
    context.set_time_limit(10)
    context.eval('"use strict";' + AUTHOR)
    context.eval('"use strict";' + SCRIPT.read_text(encoding="utf-8"))
    return context


def job_type() -> dict:
    """The script's JOB_TYPE."""
    return json.loads(_manager().eval("JSON.stringify(JOB_TYPE)"))


def compile_job(settings: dict) -> list[dict]:
    """The tasks of a job; raises quickjs.JSException where the script refuses it."""
    return json.loads(_manager().eval(f"compiled({json.dumps(settings)})"))


def command_line(task: dict, variables: dict[str, str]) -> list[str]:
    """The one command of a task, `exec`, as a worker runs it."""
    (command,) = task["commands"]
    assert command["name"] == "exec"
    line = [command["parameters"]["exe"], *command["parameters"]["args"]]
    for name, value in variables.items():
        line = [part.replace(f"{{{name}}}", value) for part in line]
    return line
