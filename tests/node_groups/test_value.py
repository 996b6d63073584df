"""`Value` makes the nodes of a formula: what they compute is what NumPy does."""

import bpy
import numpy as np
import pytest

from spectral_skylight.node_groups import tree as groups
from spectral_skylight.node_groups.value import (
    Value,
    combine_rgb,
    combine_xyz,
    math,
    vector_math,
)

pytestmark = pytest.mark.blender

RNG = np.random.default_rng(7)
COUNT = 40
NUMBERS = {name: RNG.uniform(0.2, 3.0, COUNT) for name in ("a", "b")}
VECTORS = {name: RNG.uniform(-2.0, 2.0, (COUNT, 3)) for name in ("u", "v")}


@pytest.fixture(scope="module")
def computed():
    """What a formula gives for random numbers and vectors, by geometry nodes: (40,) or (40, 3)."""
    bpy.ops.wm.read_homefile(use_empty=True)
    mesh = bpy.data.meshes.new("Points")
    mesh.from_pydata([(0.0, 0.0, 0.0)] * COUNT, [], [])
    for name, values in {**NUMBERS, **VECTORS}.items():
        kind, place = ("FLOAT", "value") if values.ndim == 1 else ("FLOAT_VECTOR", "vector")
        attribute = mesh.attributes.new(name, kind, "POINT")
        attribute.data.foreach_set(place, values.astype(np.float32).ravel())
    points = bpy.data.objects.new("Points", mesh)
    bpy.context.scene.collection.objects.link(points)
    modifier = points.modifiers.new("Formula", "NODES")

    def compute(formula):
        tree = bpy.data.node_groups.new("Formula", "GeometryNodeTree")
        for way in ("INPUT", "OUTPUT"):
            tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
        given = groups.add(tree, "NodeGroupInput").outputs[0]

        def read(name, kind):
            node = groups.add(tree, "GeometryNodeInputNamedAttribute", name, data_type=kind)
            return Value(next(socket for socket in node.outputs if socket.enabled))

        numbers = [read(name, "FLOAT") for name in NUMBERS]
        vectors = [read(name, "FLOAT_VECTOR") for name in VECTORS]
        value = formula(*numbers, *vectors)
        is_vector = value.socket.type in ("VECTOR", "RGBA")
        store = groups.add(
            tree,
            "GeometryNodeStoreNamedAttribute",
            given,
            data_type="FLOAT_VECTOR" if is_vector else "FLOAT",
            into={"Name": "result", "Value": value},
        )
        groups.add(tree, "NodeGroupOutput", store.outputs[0])
        modifier.node_group = tree
        evaluated = points.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
        result = np.zeros(COUNT * (3 if is_vector else 1), dtype=np.float32)
        place = "vector" if is_vector else "value"
        evaluated.attributes["result"].data.foreach_get(place, result)
        return result.reshape(COUNT, 3) if is_vector else result

    return compute


def dot(u, v):
    return (u * v).sum(axis=1)


FORMULAS = {
    "a + b": (lambda a, b, u, v: a + b, lambda a, b, u, v: a + b),
    "a - 2": (lambda a, b, u, v: a - 2.0, lambda a, b, u, v: a - 2.0),
    "2 - a": (lambda a, b, u, v: 2.0 - a, lambda a, b, u, v: 2.0 - a),
    "a b": (lambda a, b, u, v: a * b, lambda a, b, u, v: a * b),
    "a / b": (lambda a, b, u, v: a / b, lambda a, b, u, v: a / b),
    "1 / a": (lambda a, b, u, v: 1.0 / a, lambda a, b, u, v: 1.0 / a),
    "a^b": (lambda a, b, u, v: a**b, lambda a, b, u, v: a**b),
    "|a - b|": (lambda a, b, u, v: abs(a - b), lambda a, b, u, v: np.abs(a - b)),
    "a b + 2": (lambda a, b, u, v: a.multiply_add(b, 2.0), lambda a, b, u, v: a * b + 2.0),
    "min": (lambda a, b, u, v: a.minimum(b), lambda a, b, u, v: np.minimum(a, b)),
    "max": (lambda a, b, u, v: a.maximum(1.0), lambda a, b, u, v: np.maximum(a, 1.0)),
    "clamp": (lambda a, b, u, v: (a - b).clamp(), lambda a, b, u, v: np.clip(a - b, 0, 1)),
    "root": (lambda a, b, u, v: a.sqrt(), lambda a, b, u, v: np.sqrt(a)),
    "exp": (lambda a, b, u, v: (a * -4.4).exp(), lambda a, b, u, v: np.exp(-4.4 * a)),
    "fraction": (lambda a, b, u, v: a.fraction(), lambda a, b, u, v: a % 1.0),
    "a < b": (lambda a, b, u, v: a.less_than(b), lambda a, b, u, v: a < b),
    "a > b": (lambda a, b, u, v: a.greater_than(b), lambda a, b, u, v: a > b),
    "near": (lambda a, b, u, v: a.near(b, 0.5), lambda a, b, u, v: np.abs(a - b) <= 0.5),
    "u + v": (lambda a, b, u, v: u + v, lambda a, b, u, v: u + v),
    "u - (1, 2, 3)": (lambda a, b, u, v: u - (1.0, 2.0, 3.0), lambda a, b, u, v: u - [1, 2, 3]),
    "u v": (lambda a, b, u, v: u * v, lambda a, b, u, v: u * v),
    "u a": (lambda a, b, u, v: u * a, lambda a, b, u, v: u * a[:, None]),
    "u 2": (lambda a, b, u, v: u * 2.0, lambda a, b, u, v: u * 2.0),
    "u v + v": (lambda a, b, u, v: u.multiply_add(v, v), lambda a, b, u, v: u * v + v),
    "u a + v": (lambda a, b, u, v: u.multiply_add(a, v), lambda a, b, u, v: u * a[:, None] + v),
    "max of u": (lambda a, b, u, v: u.maximum((0.0,) * 3), lambda a, b, u, v: np.maximum(u, 0)),
    "u . v": (lambda a, b, u, v: u.dot(v), lambda a, b, u, v: dot(u, v)),
    "u . v a": (lambda a, b, u, v: u.dot(v) * a, lambda a, b, u, v: dot(u, v) * a),
    "distance": (lambda a, b, u, v: u.distance(v), lambda a, b, u, v: dot(u - v, u - v) ** 0.5),
    "unit": (lambda a, b, u, v: u.normalize(), lambda a, b, u, v: u / dot(u, u)[:, None] ** 0.5),
    "turned": (
        lambda a, b, u, v: combine_xyz(*(u.xyz()[k] for k in (2, 0, 1))),
        lambda a, b, u, v: u[:, [2, 0, 1]],
    ),
    "diffed": (
        lambda a, b, u, v: math(a.socket.id_data, "SUBTRACT", b, a),
        lambda a, b, u, v: b - a,
    ),
    "kept": (  # an operand that is None stays as it is: 0, which is multiplied
        lambda a, b, u, v: vector_math(u.socket.id_data, "MULTIPLY_ADD", None, u, v),
        lambda a, b, u, v: v,
    ),
}


@pytest.mark.parametrize("name", FORMULAS)
def test_nodes_compute_the_formula(computed, name):
    nodes, expected = FORMULAS[name]
    given = [values.astype(np.float32) for values in (*NUMBERS.values(), *VECTORS.values())]
    # Some operations of float32, whose arguments are below 20.
    np.testing.assert_allclose(computed(nodes), expected(*given), rtol=1e-5, atol=1e-5)


def test_colors_are_split_and_made():
    """In a shader's tree, where colors have no attributes: by their links."""
    tree = bpy.data.node_groups.new("Colors", "ShaderNodeTree")
    color = Value(groups.add(tree, "ShaderNodeRGB").outputs[0])
    red, green, blue = color.rgb()
    made = combine_rgb(blue, green, red).socket.node
    assert [s.links[0].from_socket.name for s in made.inputs] == ["Blue", "Green", "Red"]
    assert made.mode == red.socket.node.mode == "RGB"
    assert (color * red).socket.node.operation == "SCALE"  # a color counts as a vector
    bpy.data.node_groups.remove(tree)


def test_order_of_nodes_is_that_of_the_formula():
    tree = bpy.data.node_groups.new("Order", "ShaderNodeTree")
    x = Value(groups.add(tree, "ShaderNodeValue").outputs[0])
    (x - 1.0) / (x + 2.0).maximum(0.5)
    assert [node.operation for node in tree.nodes if node.type == "MATH"] == [
        "SUBTRACT",
        "ADD",
        "MAXIMUM",
        "DIVIDE",
    ]
    bpy.data.node_groups.remove(tree)
