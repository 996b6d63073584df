// SPDX-License-Identifier: GPL-3.0-or-later
//
// The job type `spectral-skylight` of Flamenco 3.3 or newer: compiles a plan that
// `spectral-skylight batch plan` wrote to tasks. It belongs into the folder `scripts` beside the
// Manager's executable. See README.md beside this file.

const JOB_TYPE = {
    label: "Spectral Skylight",
    description: "Render the pictures of a batch plan",
    settings: [
        { key: "plan", type: "string", subtype: "file_path", required: true,
          description: "The plan, PLAN.jsonl, with its folder where all workers see it" },
        { key: "pictures", type: "string", required: true,
          description: "Pictures by their place in the plan. Each range is one task; A-B/N is cut " +
              "into tasks of at most N pictures. Examples: '0-39', '0-39,40-79', '0-1439/12'" },
        { key: "report", type: "bool", required: false, default: false,
          description: "Write the report at the end. Needs a worker with the command " +
              "spectral-skylight" },
    ],
};

function compileJob(job) {
    const settings = job.settings;
    const plan = absolute(settings.plan);
    const renders = ranges(settings.pictures).map(function (range) {
        const task = author.Task("pictures " + range.first + "-" + range.last, "blender");
        task.addCommand(blender(plan, range));
        return task;
    });
    renders.forEach(function (task) { job.addTask(task); });
    if (settings.report) {
        const report = author.Task("report", "misc");
        report.addCommand(author.Command("exec", {
            exe: "spectral-skylight", args: ["batch", "report", plan],
        }));
        renders.forEach(function (task) { report.addDependency(task); });
        job.addTask(report);
    }
}

// A command that starts Blender without add-ons and preferences on the script beside the plan.
function blender(plan, range) {
    // Not path.join(): it would take one of the two slashes from a network share's path.
    const script = plan.replace(/[^\/\\]*$/, "render_task.py");
    return author.Command("exec", {
        exe: "{blender}",
        args: [
            "-b", "--factory-startup", "--python-exit-code", "1", "-P", script, "--", plan,
            "--first", String(range.first), "--count", String(range.last - range.first + 1),
        ],
    });
}

// Workers start commands in folders of their own, so paths are absolute on Linux, macOS or Windows,
// or start with one of the Manager's variables.
function absolute(file) {
    if (!/^(\/|\\\\|[A-Za-z]:[\\/]|\{)/.test(file || "")) {
        throw new Error("\"" + file + "\" is no absolute path");
    }
    return file;
}

// "0-39,40-99/30" as [{first: 0, last: 39}, {first: 40, last: 69}, {first: 70, last: 99}].
function ranges(pictures) {
    const found = [];
    for (const part of String(pictures).split(",")) {
        const match = /^\s*(\d+)(?:\s*-\s*(\d+))?(?:\s*\/\s*(\d+))?\s*$/.exec(part);
        const first = match ? Number(match[1]) : 0;
        const last = match && match[2] !== undefined ? Number(match[2]) : first;
        const size = match && match[3] !== undefined ? Number(match[3]) : last - first + 1;
        if (!match || last < first || size < 1) {
            throw new Error("pictures: \"" + part + "\" is no range; write A-B or A-B/N");
        }
        for (let start = first; start <= last; start += size) {
            found.push({ first: start, last: Math.min(last, start + size - 1) });
        }
    }
    return found;
}
