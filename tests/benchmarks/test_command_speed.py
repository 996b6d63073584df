"""What a command takes beside Python with numpy alone, and how much memory.

`pytest tests/benchmarks/test_command_speed.py --benchmark-enable -s` prints processor time, time
and memory. To reach, as ratios: 2.5 for a matrix, 4 under a sky and for a library; 90 MB.
"""

import os
import subprocess
import sys
import time

import numpy as np
import pytest

from spectral_skylight.tests.skies import sky_pixels, write_hdr

ROUNDS = 7
"""Of which the best counts: other work only adds."""

CLI = "from spectral_skylight.addon.cli import main; main(sys.argv[1:])"

PEAK = """
import sys
{}
for line in open("/proc/self/status") if sys.platform == "linux" else ():
    if line.startswith("VmHWM"):
        print(int(line.split()[1]) / 1e3, file=sys.stderr)
"""
"""What a process prints last is its largest memory [MB]: `ru_maxrss` begins with its parent's."""


@pytest.fixture(scope="module")
def commands(tmp_path_factory):
    """Names and arguments of what is timed, on 24 paints and a 1k sky."""
    folder = tmp_path_factory.mktemp("paints")
    rows = np.random.default_rng(0).uniform(0.05, 0.9, (41, 24))
    table = np.column_stack([np.arange(380, 781, 10), rows])
    header = ",".join(["wavelength", *(f"paint {k}" for k in range(24))])
    np.savetxt(folder / "paints.csv", table, "%.4f", ",", header=header, comments="")
    out = tmp_path_factory.mktemp("out")
    sky, paints = write_hdr(out / "sky.hdr", sky_pixels(512)), folder / "paints.csv"
    return {
        "import numpy": ["import numpy"],
        "matrix": [CLI, "matrix", paints, "--json"],
        "matrix --sky": [CLI, "matrix", paints, "--sky", sky, "--json"],
        "irradiance": [CLI, "irradiance", sky, "--out", out / "E.exr"],
        "library": [CLI, "library", folder],
    }


def cost(code, *arguments):
    """Seconds, processor's seconds and megabytes of one run; the last is NaN where not told."""
    start = time.perf_counter()
    process = subprocess.Popen(
        [sys.executable, "-c", PEAK.format(code), *map(str, arguments)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    with process.stderr:
        said = process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    assert process.returncode == 0, said
    memory = float(said.split()[-1]) if sys.platform == "linux" else float("nan")
    return time.perf_counter() - start, usage.ru_utime + usage.ru_stime, memory


def test_commands_beside_numpy(benchmark, commands):
    if benchmark.disabled:
        pytest.skip("figures only with --benchmark-enable")
    if not hasattr(os, "wait4"):
        pytest.skip("this system does not say what a process took")

    def all_of_them():
        runs = [{name: cost(*words) for name, words in commands.items()} for _ in range(ROUNDS)]
        return {name: np.min([run[name] for run in runs], axis=0) for name in commands}

    best = benchmark.pedantic(all_of_them)
    numpy_alone = best["import numpy"]
    print()
    for name, (seconds, processor, memory) in best.items():
        ratio = processor / numpy_alone[1]
        benchmark.extra_info[f"{name} / import numpy"] = ratio
        print(
            f"{name:13} {ratio:5.2f} x the processor time, {seconds / numpy_alone[0]:5.2f} x the "
            f"time ({seconds:.2f} s), {memory:4.0f} MB"
        )
