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
          description: "Write report.html beside the plan when all pictures are done" },
        { key: "scripts", type: "string", required: true,
          description: "The scripts beside the plan that workers may run: their hash and names, " +
              "as `batch flamenco` prints them" },
        { key: "names", type: "string", required: false, default: "", visible: "hidden",
          description: "A line for each task: its scene, sky and cameras" },
    ],
};

function compileJob(job) {
    const settings = job.settings;
    const plan = absolute(settings.plan);
    const run = runner(settings.scripts);
    const cut = ranges(settings.pictures);
    const names = settings.names ? settings.names.split("\n") : [];
    const renders = cut.map(function (range, index) {
        const name = names[index] || "pictures " + range.first + "-" + range.last;
        const task = author.Task(name, "blender");
        task.addCommand(blender(plan, run("render_task"), place(range), size(range)));
        return task;
    });
    renders.forEach(function (task) { job.addTask(task); });
    job.addTask(lastTask(plan, run, joined(cut), settings.report, renders));
}

// A failed picture does not fail its task, or Flamenco would end the job. This task tries it again,
// on whichever worker is free, and fails if it is still missing. Requeueing the job starts it anew.
function lastTask(plan, run, cut, report, renders) {
    const task = author.Task("missing pictures, " + (report ? "report, " : "") + "check", "blender");
    cut.forEach(function (range) {
        const args = place(range).concat("--missing");
        task.addCommand(blender(plan, run("render_task"), args, 1));
    });
    if (report) {
        task.addCommand(blender(plan, run("report"), [], 1));
    }
    cut.forEach(function (range) {
        const args = place(range).concat("--check");
        task.addCommand(blender(plan, run("render_task"), args, 1));
    });
    renders.forEach(function (each) { task.addDependency(each); });
    return task;
}

// A command that starts Blender without add-ons and preferences on a line of Python.
function blender(plan, code, args, steps) {
    const all = ["-b", "--factory-startup", "--python-exit-code", "1", "--python-expr", code, "--",
        plan].concat(args);
    // Flamenco 3.8 counts a command's steps, by a third parameter, and shows what Blender saves.
    if (author.Command.length < 3) {
        return author.Command("exec", { exe: "{blender}", args: all });
    }
    return author.Command("blender-render", {
        exe: "{blender}", exeArgs: "", argsBefore: [], blendfile: "", args: all,
    }, steps);
}

// Python in a line that runs one of the scripts beside the plan. The folder may be anyone's: the
// scripts are run as they were read and hashed, and nothing else there is imported.
function runner(scripts) {
    const match = /^([0-9a-f]{64})((?: [a-z_]+)+)$/.exec(scripts || "");
    if (!match) {
        throw new Error("scripts: give hash and names, as batch flamenco prints them");
    }
    return function (name) {
        return [
            "import sys, os, types, hashlib",
            "d = os.path.dirname(sys.argv[sys.argv.index('--') + 1])",
            "n = '" + match[2].trim() + "'.split()",
            "s = [open(os.path.join(d, m + '.py'), 'rb').read() for m in n]",
            "h = hashlib.sha256(b''.join(s)).hexdigest() == '" + match[1] + "'",
            "h or (print('the scripts beside the plan were changed', file=sys.stderr), os._exit(1))",
            "t = [types.ModuleType(m) for m in n]",
            "sys.modules.update(zip(n, t))",
            "[exec(compile(c, m, 'exec'), u.__dict__) for c, m, u in zip(s, n, t)]",
            "i = n.index('" + name + "')",
            "exec(compile(s[i], n[i], 'exec'), dict(__name__='__main__', __package__='', " +
                "__file__=os.path.join(d, n[i] + '.py')))",
        ].join("; ");
    };
}

function place(range) {
    return ["--first", String(range.first), "--count", String(size(range))];
}

function size(range) {
    return range.last - range.first + 1;
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

// Ranges that follow one another as one.
function joined(ranges) {
    const found = [];
    for (const range of ranges) {
        const end = found[found.length - 1];
        if (end && range.first === end.last + 1) {
            end.last = range.last;
        } else {
            found.push({ first: range.first, last: range.last });
        }
    }
    return found;
}
