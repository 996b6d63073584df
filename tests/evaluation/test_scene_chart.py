"""The chart of whole pictures: its fronts, what it says of them, its files; nothing is rendered."""

import csv
import sys
from pathlib import Path

import pytest

from spectral_skylight.addon import cli
from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.evaluation.scene_chart import (
    ERRORS,
    FIELDS,
    front,
    points,
    report_scenes,
    verdict,
)

pytest.importorskip("matplotlib")


def row(way, family, seconds, mean, p95=None, scene="street", **more):
    """A row of the table, as text; ``seconds``: None where it failed."""
    if seconds is None:
        return dict.fromkeys(FIELDS, "") | {"scene": scene, "way": way, "failed": "no light"}
    known = {name: mean for name in ERRORS} | {"p95": 2 * mean if p95 is None else p95}
    known |= {f"{what}processor": seconds for what in ("", "setup_", "frame_")}
    known |= {"seconds": 2 * seconds, "memory_MB": 300, "noise": 0.2, "noise_p95": 0.5} | more
    texts = {name: str(value) for name, value in known.items()}
    return dict.fromkeys(FIELDS, "") | {"scene": scene, "way": way, "family": family} | texts


ROWS = [
    row("RGB 16", "Cycles RGB", 0.5, 3.0),
    row("RGB 64", "Cycles RGB", 1.5, 1.2, 3.0),
    row("RGB 4096", "Cycles RGB", 60.0, 0.7, 1.6),
    row("ours first", "Ours in Cycles", 6.0, 0.4, 0.9, hour_processor=2.0),
    row("ours", "Ours in Cycles", 15.0, 0.3, 0.6),
    row("Eevee", "Eevee", 30.0, 12.0),
    row("probes", "Eevee", None, None),
]


def test_the_front_is_what_nothing_beats():
    some = points(ROWS)
    assert [point.way for point in front(some)] == ["RGB 16", "RGB 64", "ours first", "ours"]
    # What is hardly nearer for more time is the noise's.
    some += points([row("ours again", "Ours in Cycles", 40.0, 0.299)])
    assert [point.way for point in front(some)][-1] == "ours"
    assert [point.way for point in front(some, "hour_")] == ["ours first"]
    assert front([]) == []


def test_what_is_not_ours_on_the_front_is_said():
    said = "; ".join(verdict(points(ROWS)))
    # What was there before a second is the best until something nearer is.
    rivals = "RGB 16 (0.5 s, 3.00), RGB 64 (1.5 s, 1.20); from 6.0 s on it is"
    assert f"not all of the front is ours: {rivals}" in said
    assert "never reaches ours' mean error: 0.70 at best, ours 0.30" in said
    # Ours' first of at most 1.5 times the least error, against the best that is there by then.
    assert "in 6.0 s RGB × RGB has 3.3 times ours' 95th percentile" in said
    early = row("ours at once", "Ours in Cycles", 0.9, 1.0)
    alone = verdict(points([early, *ROWS]))
    assert alone[0] == "from one second on the front is ours alone"
    better = points([*ROWS, row("RGB exact", "Cycles RGB", 90.0, 0.1)])
    assert any("RGB × RGB reaches ours' mean error" in line for line in verdict(better))
    assert verdict(better)[0].endswith("RGB exact (90.0 s, 0.10)")  # and none after it


def test_files_say_what_was_measured_and_what_was_not(tmp_path):
    files = report_scenes(tmp_path, [*ROWS, row("RGB 16", "Cycles RGB", 0.4, 2.0, scene="sun")])
    assert {path.name for path in files} >= {"scenes.png", "scenes_again.png", "scenes.md"}
    text = (tmp_path / "scenes.md").read_text(encoding="utf-8")
    assert "## street" in text and "## sun" in text and "- street, probes: no light" in text
    assert "| **ours** | 15.0 | 15.0 (30.0) |" in text and "cores" in text
    assert (tmp_path / "scenes.png").stat().st_size > 10_000
    with pytest.raises(InputError, match="has no point"):
        report_scenes(tmp_path, [row("probes", "Eevee", None, None)])


@pytest.fixture
def program(monkeypatch):
    """The examples' program."""
    monkeypatch.syspath_prepend(str(Path(__file__).resolve().parents[2] / "examples"))
    import scene_points

    return scene_points


def test_measuring_goes_on_where_it_was_stopped(program, monkeypatch, tmp_path):
    done, state = [], "a scene"

    def in_a_process(work, *arguments):
        if work == program.prepared:
            names = [f"Cycles RGB, 16 samples{how}" for how in ("", ", denoised")]
            return dict.fromkeys(arguments[0], state), ".program", names
        name, way, _ = arguments
        if len(done) == 3:
            raise KeyboardInterrupt
        done.append((name, way))
        if name == "sun":
            raise RuntimeError("not done after 900 s")
        return [{name: each for name, each in row(way, "Cycles RGB", 1.0, 1.0).items() if each}]

    monkeypatch.setattr(program, "_in_a_process", in_a_process)
    wanted = ["street", "sun"], ["Cycles RGB, 16*"], tmp_path, tmp_path
    with pytest.raises(KeyboardInterrupt):
        program.measure(*wanted)
    assert len(program.read(tmp_path / "scenes.csv")) == 3
    before = done.copy()
    done.clear()
    program.measure(*wanted)
    assert len(done) == 1 and done[0] not in before
    program.measure(*wanted)
    assert len(done) == 1  # all is there
    failed = {each["scene"]: each["failed"] for each in program.read(tmp_path / "scenes.csv")}
    assert failed == {"street": "", "sun": "not done after 900 s"}
    state = "another scene"
    done.clear()
    program.measure(["sun"], ["Cycles RGB, 16 samples"], tmp_path, tmp_path)
    rows = program.read(tmp_path / "scenes.csv")
    assert done == [("sun", "Cycles RGB, 16 samples")] and len(rows) == 4
    with pytest.raises(InputError, match="--ways"):
        program.measure(["sun"], ["no such way"], tmp_path, tmp_path)


def test_what_others_measure_meanwhile_stays(program, monkeypatch, tmp_path):
    path = tmp_path / "scenes.csv"

    def in_a_process(work, *arguments):
        if work == program.prepared:
            return {"street": "a scene"}, ".program", ["Cycles RGB, 16 samples"]
        others = row("Mitsuba 3, 16 samples", "Mitsuba 3", 1.0, 1.0)
        program.write_csv(path, FIELDS, [[others[field] for field in FIELDS]])
        return [{}]

    monkeypatch.setattr(program, "_in_a_process", in_a_process)
    program.measure(["street"], ["*"], tmp_path, tmp_path)
    ways = [each["way"] for each in program.read(path)]
    assert ways == ["Mitsuba 3, 16 samples", "Cycles RGB, 16 samples"]


def test_without_the_peers_one_line_says_how_to_have_them(program, monkeypatch, tmp_path, capsys):
    pytest.importorskip("bpy", reason="bpy is not installed")
    import ways

    assert {"Mitsuba 3, 16 samples", "Radiance, low quality"} < set(ways.WAYS)
    monkeypatch.setattr("ways_peers.peer.PYTHON", tmp_path / "python")
    assert ways.there() == [name for name in ways.WAYS if not name.startswith(("Mits", "Radi"))]
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("Mitsuba 3 and Radiance: ") and "sh tests/peers/run" in line
    monkeypatch.setattr("ways_peers.peer.PYTHON", tmp_path)
    assert ways.there() == list(ways.WAYS) and not capsys.readouterr().err


def test_a_table_of_other_columns_is_refused(program, tmp_path):
    with (tmp_path / "scenes.csv").open("w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([["scene", "way"], ["street", "ours"]])
    with pytest.raises(InputError, match="other columns"):
        program.read(tmp_path / "scenes.csv")


def test_the_command_calls_the_examples(monkeypatch, tmp_path, capsys):
    called = []

    class Done:
        returncode = 0

    def run(command, check):
        called.append(command)
        return Done

    monkeypatch.setattr("subprocess.run", run)
    out = ["chart", "--out", str(tmp_path)]
    assert cli.main([*out, "--scenes", "street", "--ways", "Ours*"]) == 0
    (command,) = called
    assert command[0] == sys.executable and Path(command[1]).is_file()
    assert command[2:] == ["--out", str(tmp_path), "--scenes", "street", "--ways", "Ours*"]
    assert cli.main([*out, "--ways", "Ours*"]) == 2
    assert "add --scenes" in capsys.readouterr().err
    Done.returncode = 3
    assert cli.main([*out, "--scenes"]) == 2
    assert "exit code 3" in capsys.readouterr().err
