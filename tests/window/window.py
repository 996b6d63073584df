"""A Blender with its window, worked as a person does: read the screen, press, type."""

from __future__ import annotations

import csv
import difflib
import io
import json
import os
import re
import shutil
import signal
import subprocess
import time
from pathlib import Path

HERE = Path(__file__).parent
SHOTS = HERE.parents[1] / "examples" / "out" / "window"
CERTIFICATES = Path("/etc/ssl/certs/ca-certificates.crt")
DISPLAY = f":{100 + os.getpid() % 800}"
"""One for each run, for two may share a machine."""
WIDTH, HEIGHT = 1100, 700
Box = tuple[int, int, int, int]
"""Left, top, width and height on the screen [pixels]."""
Word = tuple[str, Box]
FREEZE = 0.3
"""[s] of the main thread's processor time that the add-on may take between two looks at events:
what a person takes for a pause. Of processor time, for the tests of all lanes run beside."""
ENLARGED = 3
"""Letters are 8 pixels high on the screen; tesseract wants 20 or more."""


class Debian:
    """The folder with Debian in it, and a fresh folder inside for one test."""

    def __init__(self, root: Path, name: str):
        self.root = root
        self.inside = f"/tmp/skylight-{name}-{os.getpid()}"
        self.folder = root / self.inside.lstrip("/")
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)
        if CERTIFICATES.exists():  # of whoever stands between this machine and the network
            shutil.copy(CERTIFICATES, self.folder)

    def environment(self) -> dict[str, str]:
        """Nothing of the machine's own but the way to the network."""
        kept = {k: v for k, v in os.environ.items() if "INDEX_URL" in k or "proxy" in k.lower()}
        return {
            **kept,
            "PIP_CERT": f"{self.inside}/{CERTIFICATES.name}",
            "PATH": "/usr/sbin:/usr/bin:/sbin:/bin:/usr/games",
            "HOME": self.inside,
            "DISPLAY": DISPLAY,
            "LANG": "C.UTF-8",
            "LIBGL_ALWAYS_SOFTWARE": "1",
            "SPECTRAL_SKYLIGHT_CACHE": f"{self.inside}/cache",
        }

    def start(self, *command: str, log: str = "log") -> subprocess.Popen[bytes]:
        """Start a command inside; what it prints goes to a file of the folder."""
        with (self.folder / log).open("ab") as file:
            return subprocess.Popen(
                ["chroot", str(self.root), *command],
                env=self.environment(),
                stdout=file,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )

    def run(self, *command: str, check: bool = True) -> str:
        """Run a command inside; what it printed. Raises RuntimeError where it fails."""
        done = subprocess.run(
            ["chroot", str(self.root), *command],
            env=self.environment(),
            capture_output=True,
            text=True,
        )
        if check and done.returncode:
            raise RuntimeError(f"{' '.join(command)}: {done.stdout}{done.stderr}")
        return done.stdout + done.stderr


class Window:
    """Blender under a display in memory; a context manager."""

    def __init__(self, debian: Debian):
        self.debian = debian
        self.clicks = 0
        """Of the mouse, a double one for one."""
        self._processes: list[subprocess.Popen[bytes]] = []

    def __enter__(self) -> Window:
        try:
            return self._start()
        except BaseException:
            self.__exit__()
            raise

    def _start(self) -> Window:
        for name in ("agent.py", "freezes.py"):
            shutil.copy(HERE / name, self.debian.folder)
        (self.debian.folder / "started").unlink(missing_ok=True)
        screen = f"{WIDTH}x{HEIGHT}x24"
        self.screen = self.debian.start("Xvfb", DISPLAY, "-screen", "0", screen, log="xvfb")
        self._processes.append(self.screen)
        time.sleep(1)
        self.blender = self.debian.start(
            *("blender", "--gpu-backend", "opengl"),  # Vulkan in software crashes
            *("--window-geometry", "0", "0", str(WIDTH), str(HEIGHT)),
            *("--python", f"{self.debian.inside}/agent.py", "--", self.debian.inside),
            log="blender",
        )
        self._processes.append(self.blender)
        self._until(lambda: (self.debian.folder / "started").exists(), 60, "Blender did not start")
        self.ask("True")
        return self

    def __exit__(self, *_: object) -> None:
        for process in self._processes:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
        self._processes.clear()

    def ask(self, expression: str, timeout: float = 120) -> object:
        """The value of an expression inside Blender, once it has time for it."""
        ask, answer = self.debian.folder / "ask", self.debian.folder / "answer"
        answer.unlink(missing_ok=True)
        part = ask.with_suffix(".part")
        part.write_text(expression)
        part.replace(ask)
        self._until(answer.exists, timeout, f"no answer to {expression}")
        said = json.loads(answer.read_text())
        if "error" in said:
            raise RuntimeError(said["error"])
        return said["value"]

    def step(self, name: str) -> None:
        """What is done from now on belongs to a step of this name in the table of freezes."""
        self.ask(f"watched.begin({name!r})")

    def no_freeze(self) -> None:
        """Print how long the window stood still in each step, and what of that was ours, which must
        be under `FREEZE`."""
        table = self.ask("watched.table()")
        print(f"\n{'step':<20} longest  ours [s]  in")
        for name, longest, ours, what, where in table:
            print(f"{name:<20} {longest:7.2f} {ours:9.2f}  {what}  {where}")
        frozen = [(name, ours, what) for name, _, ours, what, _ in table if ours > FREEZE]
        assert not frozen, frozen

    def wait(self, expression: str, timeout: float = 120) -> None:
        """Wait until an expression inside Blender is true."""
        until = time.monotonic() + timeout
        while not self.ask(expression):
            if time.monotonic() > until:
                self.shot("failed")
                raise AssertionError(f"still not: {expression}")
            time.sleep(0.3)

    def wait_for_shaders(self, timeout: float = 240) -> None:
        """Wait until the 3D view no longer says that it compiles."""
        left, top, _, _ = self.box("WINDOW") or (0, 0, 0, 0)
        until = time.monotonic() + timeout
        time.sleep(5)
        while "ompil" in self.text((left, top, 320, 130)):
            assert time.monotonic() < until, "shaders still compile"
            time.sleep(3)

    def pointer(self, *command: object) -> None:
        """One call of xdotool."""
        self.clicks += command[0] == "click" and command[-1] == "1"
        self.debian.run("xdotool", *map(str, command))

    def key(self, *names: str) -> None:
        """Press keys, one after another; `F3` and the like by their place on the keyboard."""
        for name in names:  # by their names xdotool's function keys do not arrive
            f = re.fullmatch(r"F(\d)", name)
            self.pointer("key", 66 + int(f[1]) if f else name)
            time.sleep(0.2)

    def type(self, text: str) -> None:
        self.pointer("type", "--delay", "30", "--", text)

    def hover(self, box: Box) -> None:
        """Move the pointer to the middle of a box: Blender's keys go to what is under it."""
        left, top, width, height = box
        self.pointer("mousemove", left + width // 2, top + height // 2)
        time.sleep(0.3)

    def press(self, label: str, times: int = 1) -> None:
        """Find a label, in the sidebar first, and click on it; wait for what that starts."""
        self.hover(self.find(label))
        self.pointer("click", "--repeat", times, "--delay", "80", "1")
        time.sleep(1)
        self.wait("not at_work()", 120)

    def press_tab(self, label: str) -> None:
        """Open the 3D view's sidebar at a tab."""
        self.hover(self.box("WINDOW"))
        if self.box("UI") is None:
            self.key("n")
            self.wait("region('VIEW_3D', 'UI') is not None")
            time.sleep(1)
        for _ in range(10):
            left, top, width, height = self.box("UI") or (0, 0, 0, 0)
            found = _match(self.read((left + width - 24, top, 24, height), turned=True), label)
            if found:
                break
            time.sleep(1)
        assert found, f"no tab {label}"
        self.hover(found)
        self.pointer("click", "1")
        time.sleep(2)

    def box(self, region: str, area: str = "VIEW_3D") -> Box | None:
        """Where a region of an editor is on the screen."""
        found = self.ask(f"region({area!r}, {region!r})")
        return None if found is None else tuple(found)

    def find(self, label: str) -> Box:
        """The box of a label: in the sidebar as it is, on the screen, in the sidebar scrolled.

        AssertionError where it is not to be read.
        """
        sidebar = self.box("UI")
        for box in [b for b in (sidebar, None) if b or not sidebar]:
            if found := _match(words := self.read(box), label):
                return found
        for scroll in ("4",) * 30, *(("5",) * 4,) * 6:
            if sidebar is None:
                break
            self.hover(sidebar)
            self.pointer("click", "--repeat", len(scroll), "--delay", "20", scroll[0])
            time.sleep(0.7)
            if found := _match(words := self.read(sidebar), label):
                return found
        self.shot("failed")
        seen = " ".join(word for word, _ in words)
        raise AssertionError(f"{label!r} is not on the screen, only: {seen}")

    def read(self, box: Box | None = None, turned: bool = False) -> list[Word]:
        """The words on the screen or in a box of it; those of tabs are turned by 90 degrees."""
        left, top, width, height = box or (0, 0, WIDTH, HEIGHT)
        crop = f"{width}x{height}+{left}+{top}"
        shot = f"{self.debian.inside}/read.png"
        self.debian.run(
            *("import", "-window", "root", "-crop", crop, "+repage", "-colorspace", "gray"),
            *(
                "-rotate",
                "-90" if turned else "0",
                "-negate",
                "-resize",
                f"{100 * ENLARGED}%",
                shot,
            ),
        )
        text = self.debian.run("tesseract", shot, "-", "--psm", "11", "tsv")
        words = []
        for row in csv.DictReader(io.StringIO(text), delimiter="\t", quoting=csv.QUOTE_NONE):
            if not (row.get("text") or "").strip():
                continue
            x, y, w, h = (int(row[k]) // ENLARGED for k in ("left", "top", "width", "height"))
            if turned:
                x, y, w, h = width - y - h, x, h, w
            words.append((row["text"], (x + left, y + top, w, h)))
        return words

    def text(self, box: Box | None = None) -> str:
        """What can be read on the screen, or in a box of it."""
        return " ".join(word for word, _ in self.read(box))

    def shot(self, name: str, box: Box | None = None) -> Path:
        """Keep a picture of the screen, or of a box of it; its path."""
        left, top, width, height = box or (0, 0, WIDTH, HEIGHT)
        SHOTS.mkdir(parents=True, exist_ok=True)
        inside = f"{self.debian.inside}/shot.png"
        self.debian.run(
            *("import", "-window", "root", "-crop", f"{width}x{height}+{left}+{top}", "+repage"),
            *("-depth", "8", "+dither", "-colors", "128", f"PNG8:{inside}"),
        )
        return Path(shutil.copy(self.debian.folder / "shot.png", SHOTS / f"{name}.png"))

    def _until(self, true, timeout: float, otherwise: str) -> None:
        until = time.monotonic() + timeout
        while not true():
            if self.blender.poll() is not None or time.monotonic() > until:
                log = (self.debian.folder / "blender").read_text(errors="replace")
                raise AssertionError(f"{otherwise}:\n{log[-2000:]}")
            time.sleep(0.1)


def _match(words: list[Word], label: str) -> Box | None:
    """The box of the run of words beside one another that reads most like a label, or None."""
    wanted = _letters(label)
    best = (0.82, None)
    for start in range(len(words)):
        for length in range(1, len(label.split()) + 2):
            run = words[start : start + length]
            if len(run) < length or not all(map(_beside, run, run[1:])):
                break
            text = _letters("".join(word for word, _ in run))
            ratio = difflib.SequenceMatcher(None, wanted, text).ratio()
            around = [words[max(start - 1, 0) : start + 1], words[start + length - 1 :][:2]]
            if any(len(pair) == 2 and _beside(*pair) for pair in around):
                ratio -= 0.1  # in a sentence; a button's name stands alone
            if ratio > best[0]:
                left, top = (min(box[k] for _, box in run) for k in (0, 1))
                right, bottom = (max(box[k] + box[k + 2] for _, box in run) for k in (0, 1))
                best = (ratio, (left, top, right - left, bottom - top))
    return best[1]


def _beside(one: Word, other: Word) -> bool:
    """Whether a word follows another on the same line."""
    (_, (x, y, w, h)), (_, (x2, y2, _, h2)) = one, other
    return abs((y + h / 2) - (y2 + h2 / 2)) < 6 and -3 <= x2 - x - w < 14


def _letters(text: str) -> str:
    return re.sub(r"[^a-z0-9]", "", text.lower())
