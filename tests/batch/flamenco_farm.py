"""A farm as Flamenco runs one: a Manager behind HTTP, and workers that do one task after another.

Written after what Flamenco's documentation and API say, and after what a real Manager did: a
worker that fails a task does not get it again; three such failures fail the task; three failures
of a kind shut a worker out of a job's tasks of that kind; where at most one other worker is left
for a failed task the job fails at once, and so it does where a tenth of its tasks have failed; what
then waits is canceled. Of a task's output a worker knows two lines, ``Saved: '…'`` and ``Time: …``.
"""

from __future__ import annotations

import http.server
import json
import re
import subprocess
import threading
from collections import defaultdict
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from spectral_skylight.tests.batch import flamenco_manager as manager

SAVED = re.compile(r"^(?:.* \| )?Saved: '(.*)'")
STEP = re.compile(r"^(?:.* \| )?Time: ([0-9:.]+)")


@contextmanager
def answering(replies):
    """A server on the loopback address; `replies` maps a path to a function of what was sent."""

    class Handler(http.server.BaseHTTPRequestHandler):
        def do_GET(self):
            length = int(self.headers.get("Content-Length", 0))
            code, content = 404, {"code": 404, "message": "no such job type known"}
            if self.path in replies:
                code, content = replies[self.path](json.loads(self.rfile.read(length) or "null"))
            self.send_response(code)
            if code == 302:
                self.send_header("Location", content)
            self.end_headers()
            raw = content if isinstance(content, bytes) else json.dumps(content).encode()
            self.wfile.write(raw)

        do_POST = do_GET

        def log_message(self, *_):
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield f"http://127.0.0.1:{server.server_port}"
    finally:
        server.shutdown()
        server.server_close()


class Farm:
    """A Manager with its workers. ``variables``: such as ``blender``; ``tags``: by their names."""

    def __init__(
        self,
        workers: int,
        variables: dict[str, str],
        version: tuple[int, int] = manager.NEWEST,
        tags: dict[str, set[int]] | None = None,
        **how: Any,
    ) -> None:
        self.workers, self.variables, self.version = range(workers), variables, version
        self.tags, self.how = tags or {}, how
        self.jobs: list[dict[str, Any]] = []
        self.tasks: list[dict[str, Any]] = []
        self.status = ""
        self._blocked: set[tuple[int, str]] = set()
        self._failures: dict[tuple[int, str], set[str]] = defaultdict(set)

    def replies(self):
        """What its API answers, by path."""
        kind = {**manager.job_type(self.version), "name": "spectral-skylight", "etag": "4711"}
        tags = [{"id": f"id of {name}", "name": name} for name in self.tags]
        found = {
            "/api/v3/version": {"version": ".".join(map(str, self.version)), "name": "Flamenco"},
            "/api/v3/jobs/type/spectral-skylight": kind,
            "/api/v3/worker-mgt/tags": {"tags": tags} if tags else {},
            "/api/v3/worker-mgt/workers": {
                "workers": [
                    {"id": str(n), "name": f"w{n}", "status": "awake"} for n in self.workers
                ]
            },
        }
        for number in self.workers:
            own = [tag for tag in tags if number in self.tags[tag["name"]]]
            found[f"/api/v3/worker-mgt/workers/{number}"] = {"id": str(number), "tags": own}
        fixed = {path: lambda _, content=content: (200, content) for path, content in found.items()}
        return {**fixed, "/api/v3/jobs": self._take}

    def _take(self, job):
        if job["type_etag"] != "4711":
            return 412, {"code": 412, "message": "its settings are outdated"}
        self.jobs.append(job)
        settings = {key: self._two_way(value) for key, value in job["settings"].items()}
        self.tasks = manager.compile_job(settings, self.version)
        for task in self.tasks:
            steps = sum(command["totalStepCount"] for command in task["commands"])
            task |= {"status": "queued", "failed by": set(), "log": "", "steps": 0, "all": steps}
            task["previews"] = []
        self.status = "queued"
        return 200, {**job, "id": "d0e5"}

    def _two_way(self, value):
        for name, place in self.variables.items():
            if name != "blender" and isinstance(value, str):
                value = value.replace(place, f"{{{name}}}")
        return value

    def run(self):
        """Let the workers work in turn until none finds a task; return the job's status."""
        self.status, idle = "active", 0
        while self.status == "active" and idle < len(self.workers):
            for worker in self.workers:
                task = self._task_for(worker)
                idle = 0 if task else idle + 1
                if task and self.status == "active":
                    self._work(worker, task)
        return self.status

    def requeue(self):
        """Queue again what did not succeed, for all workers, and run."""
        self._blocked.clear()
        self._failures.clear()
        for task in self.tasks:
            if task["status"] != "completed":
                task |= {"status": "queued", "failed by": set(), "log": ""}
        return self.run()

    def _task_for(self, worker):
        done = {task["uuid"] for task in self.tasks if task["status"] == "completed"}
        for task in self.tasks:
            if (
                task["status"] in ("queued", "soft-failed")
                and worker not in task["failed by"]
                and (worker, task["type"]) not in self._blocked
                and set(task["dependencies"]) <= done
            ):
                return task
        return None

    def _work(self, worker, task):
        for command in task["commands"]:
            line = manager.line_of(command, self.variables)
            both = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
            done = subprocess.run(line, **both, check=False, **self.how)
            task["log"] += done.stdout
            if command["name"] == "blender-render":
                self._understand(task, done.stdout)
            if done.returncode:
                self._fail(worker, task)
                return
        task |= {"status": "completed", "steps": task["all"]}
        if all(each["status"] == "completed" for each in self.tasks):
            self.status = "completed"

    def _understand(self, task, output):
        task["counted"] = 0
        for line in output.splitlines():
            task["counted"] += bool(STEP.match(line))
            if saved := SAVED.match(line):
                assert Path(saved[1]).is_file(), line
                task["previews"].append(saved[1])

    def _fail(self, worker, task):
        task["failed by"].add(worker)
        task["status"] = "soft-failed"
        failures = self._failures[worker, task["type"]]
        failures.add(task["uuid"])
        if len(failures) >= 3:
            self._blocked.add((worker, task["type"]))
        left = [w for w in self.workers if (w, task["type"]) not in self._blocked]
        if len(task["failed by"]) >= 3:
            task["status"] = "failed"
            failed = sum(each["status"] == "failed" for each in self.tasks)
            ends = 10 * failed >= len(self.tasks)
        else:
            ends = len(set(left) - task["failed by"]) <= 1
        if ends or not left:
            task["status"] = self.status = "failed"
            for each in self.tasks:
                if each["status"] in ("queued", "soft-failed"):
                    each["status"] = "canceled"
