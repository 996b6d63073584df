"""What an Eevee sample of Skylight Surface costs beside plain Diffuse and Principled.

`pytest tests/benchmarks/test_eevee_cost.py --benchmark-enable -s` prints the ratios.
"""

import time

import numpy as np
import pytest

bpy = pytest.importorskip("bpy")

from spectral_skylight.addon.scene import materials, sky_light  # noqa: E402
from spectral_skylight.tests import faces  # noqa: E402

pytestmark = [pytest.mark.blender, pytest.mark.slow]


def plain(shader):
    material = bpy.data.materials.new(shader)
    if bpy.app.version < (5, 0, 0):
        material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    node, output = tree.nodes.new(shader), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return material


def skylight(world):
    material = bpy.data.materials.new("Skylight")
    materials.apply(material, world, 0.5 * np.eye(3), reflectance_name="", reflectance_hash="")
    sky_light.set_coefficients(world, np.full((49, 3), 0.02))
    return material


def test_sample_cost(benchmark, tmp_path, capsys):
    """One plane fills the picture; rounds are interleaved, for other work on the machine hits all.

    The cost of a sample is the difference between renders of many and of few, per sample: what a
    render costs whatever its samples drops out. Ratios are taken within a round. Two clocks: the
    wall's, and the processor time of this process, which on a software OpenGL is the whole cost and
    blind to what else the machine does.
    """
    scene = faces.empty_scene()
    world = faces.light(scene, tmp_path)
    bpy.ops.mesh.primitive_plane_add(size=4)
    bpy.context.object.data.materials.append(None)
    slot = bpy.context.object.material_slots[0]
    faces.watch(scene, (0.0, 0.0), 2.0)
    timed = not benchmark.disabled
    size, samples, rounds = (512, (1, 5), 5) if timed else (32, (1, 2), 1)
    scene.render.resolution_x = scene.render.resolution_y = size
    shown = {
        "Diffuse": plain("ShaderNodeBsdfDiffuse"),
        "Principled": plain("ShaderNodeBsdfPrincipled"),
        "Emission": plain("ShaderNodeEmission"),
        "Skylight Surface": skylight(world),
    }

    def render(material, count):
        slot.material = material
        scene.eevee.taa_render_samples = count
        start = np.array([time.perf_counter(), time.process_time()])
        bpy.ops.render.render()
        return np.array([time.perf_counter(), time.process_time()]) - start

    for material in shown.values():
        render(material, 1)  # compiles
    cost = {name: [] for name in shown}

    def one_round():
        for name, material in shown.items():
            few, many = (render(material, count) for count in samples)
            cost[name].append((many - few) / (samples[1] - samples[0]))

    benchmark.pedantic(one_round, rounds=rounds)
    if timed:
        with capsys.disabled():
            print(f"\nBlender {bpy.app.version_string}, {size} px: one sample, median of {rounds}")
            for name, times in cost.items():
                wall, processor = 1e3 * np.median(times, axis=0)
                print(f"{name:17s} {wall:7.1f} ms wall, {processor:7.1f} ms processor", end="")
                for other in ("Diffuse", "Principled"):
                    ratio = np.median(np.divide(times, cost[other]), axis=0)
                    print(f"; {ratio[0]:.3f} and {ratio[1]:.3f} {other}", end="")
                    benchmark.extra_info[f"{name} / {other}"] = ratio.tolist()
                print()
    assert set(cost) == set(shown) and all(len(times) == rounds for times in cost.values())
