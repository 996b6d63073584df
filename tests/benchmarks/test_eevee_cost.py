"""What an Eevee sample of Skylight Surface costs beside plain Diffuse and Principled.

`pytest tests/benchmarks/test_eevee_cost.py --benchmark-enable -s` prints the ratios.
"""

import numpy as np
import pytest

bpy = pytest.importorskip("bpy")

from spectral_skylight.addon.scene import cost  # noqa: E402

pytestmark = [pytest.mark.blender, pytest.mark.slow]


def test_sample_cost(benchmark, capsys):
    """Figures, no limits. What `addon.scene.cost` makes for it is gone afterwards."""
    timed = not benchmark.disabled
    size, samples, rounds = (512, (1, 5), 5) if timed else (32, (1, 2), 1)
    before = [len(data) for data in (bpy.data.scenes, bpy.data.materials, bpy.data.objects)]
    costs = benchmark.pedantic(lambda: list(cost.sample_costs(size, samples, rounds))[-1])
    if timed:
        with capsys.disabled():
            print(f"\nBlender {bpy.app.version_string}, {size} px: one sample, median of {rounds}")
            for name, one in costs.items():
                wall, processor = one.milliseconds
                print(f"{name:19s} {wall:7.1f} ms wall, {processor:7.1f} ms processor", end="")
                for other in ("Diffuse", "Principled"):
                    ratio = np.median(one.seconds / costs[other].seconds, axis=0)
                    print(f"; {ratio[0]:.3f} and {ratio[1]:.3f} {other}", end="")
                    benchmark.extra_info[f"{name} / {other}"] = ratio.tolist()
                print()
    assert {"Diffuse", "Principled", "Emission", "irradiance texture", cost.OURS} == set(costs)
    assert all(one.seconds.shape == (rounds, 2) for one in costs.values())
    assert costs["Diffuse"].ratio == (1.0, 1.0)
    assert before == [len(data) for data in (bpy.data.scenes, bpy.data.materials, bpy.data.objects)]
