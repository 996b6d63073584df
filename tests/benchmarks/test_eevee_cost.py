"""What an Eevee sample of Skylight Surface costs beside plain Diffuse and Principled.

`pytest tests/benchmarks/test_eevee_cost.py --benchmark-enable -s` prints the ratios.
"""

import bpy
import pytest

from spectral_skylight.addon.scene.output import eevee_cost
from spectral_skylight.tests.lanes import newest

pytestmark = [pytest.mark.blender, pytest.mark.slow]


@newest
def test_sample_cost(benchmark, capsys):
    """Figures, no limits. What `addon.scene.output.eevee_cost` makes for it is gone afterwards."""
    timed = not benchmark.disabled
    given = {} if timed else {"size": 32, "samples": (1, 2), "rounds": 1}
    before = [len(data) for data in (bpy.data.scenes, bpy.data.materials, bpy.data.objects)]
    costs = benchmark.pedantic(lambda: list(eevee_cost.sample_costs(**given))[-1])
    if timed:
        with capsys.disabled():
            print(f"\nBlender {bpy.app.version_string}: one sample, the least of all rounds")
            for name, one in costs.items():
                benchmark.extra_info[name] = [one.ratio, one.wall_ratio]
                print(
                    f"{name:19s} {one.ms_wall:7.1f} ms wall, {one.ms_processor:7.1f} ms processor; "
                    f"{one.wall_ratio:.3f} and {one.ratio:.3f} of Diffuse"
                )
    others = {"Diffuse", "Principled", "Emission", "irradiance texture"}
    assert set(costs) == {*others, eevee_cost.OURS, *eevee_cost.LIT}
    assert costs["Diffuse"].ratio == costs["Diffuse"].wall_ratio == 1.0
    assert before == [len(data) for data in (bpy.data.scenes, bpy.data.materials, bpy.data.objects)]
