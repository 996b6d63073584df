"""`Sky Bake`: the last modifier of a baked object, which gives its corners what was baked for them.

The user's mesh stays as it is. What arrives from the modifiers before (instances made real, for one
bake holds one place each) is subdivided face by face, as finely as the light needs, without moving
the surface or its normals; then each corner takes the bake's values of the same number. Where
the geometry is no longer what was baked, by count or place of a corner, the flag stays 0, and the
material falls back to the open sky.

The bake is a mesh object of ours that no scene holds: its faces are the subdivided ones, their
vertices split where normals are, so that a value lies there once; loose vertices after them hold a
number for each face before subdivision.

Under a sky that moves, the variant `DAY` shows light that moves with it: the bake holds it for some
moments, of which two are mixed, over the sky's level; what does not follow the sky is added. These
two numbers are values inside, so all objects of a World follow by one driver each.
"""

from __future__ import annotations

from functools import partial

import bpy

from . import baked_light
from . import tree as groups
from .tree import Socket
from .value import Value, inputs

KIND = "Sky Bake"
VERSION = 3
LEVELS = 7  # a face of four corners then has 128 x 128 cells
LEVEL = "skylight_level"  # on a loose vertex: how often its face is halved
SPLIT = "skylight_split"  # … whether it is triangulated first
FACE = "skylight_face"  # on the subdivided faces: the number of the face before
NEAR = 1e-4  # how far a corner may lie from where it was baked, of the object's size

DAY = "day"
KEY, SKY_LEVEL = "Key", "Level"
"""Nodes of the `DAY` variant: the number of the moment, between whole numbers a mixture of two, and
what its light is multiplied by."""

INPUTS = (
    Socket("Geometry", "Geometry", "Geometry that the modifiers before this one leave"),
    Socket("Bake", "Object", "Object that holds the baked values. It is in no scene"),
    Socket(
        "Faces",
        "Int",
        "Index of the bake's first loose vertex. Each of them says how finely one face is divided",
    ),
    Socket(
        "Near", "Float", "Distance in object units that a corner may have from where it was baked"
    ),
    Socket("Back", "Bool", "Store light on faces seen from behind, in one more attribute"),
)
OUTPUTS = (Socket("Geometry", "Geometry", "Subdivided geometry with the baked attributes"),)


def ensure() -> bpy.types.NodeTree:
    """The `Sky Bake` group of this file, made or updated."""
    still = (tree for tree in groups.of_kind(KIND) if not is_day(tree))
    return _ensure(next((t for t in still if not groups.is_newer(t, VERSION)), None), "")


def ensure_day() -> bpy.types.NodeTree:
    """A new `Sky Bake` group of the variant `DAY`."""
    return _ensure(None, DAY)


def is_day(tree: bpy.types.NodeTree | None) -> bool:
    """Whether a group shows light that moves."""
    return tree is not None and tree.get(groups.VARIANT) == DAY


def at_key(name: str, key: int | str) -> str:
    """The attribute that holds what ``name`` is at a moment, over the sky's level."""
    return f"{name}_{key}"


def _ensure(tree: bpy.types.NodeTree | None, variant: str) -> bpy.types.NodeTree:
    return groups.ensure(
        tree,
        KIND,
        VERSION,
        INPUTS,
        OUTPUTS,
        partial(_build, moves=variant == DAY),
        variant,
        "GeometryNodeTree",
    )


def _build(tree: bpy.types.NodeTree, moves: bool) -> None:
    add = partial(groups.add, tree)
    given = inputs(tree)
    info = add("GeometryNodeObjectInfo", transform_space="ORIGINAL", into={"Object": given["Bake"]})
    bake = info.outputs["Geometry"]
    index = Value(add("GeometryNodeInputIndex").outputs[0])

    def named(name, data_type):
        return add("GeometryNodeInputNamedAttribute", name, data_type=data_type).outputs[
            "Attribute"
        ]

    def sample(name, data_type, domain, at, value=None):
        value = value or named(name, data_type)
        node = add("GeometryNodeSampleIndex", bake, value, at, data_type=data_type, domain=domain)
        return Value(node.outputs["Value"])

    def store(geometry, name, value, data_type, domain):
        node = add(
            "GeometryNodeStoreNamedAttribute",
            geometry,
            data_type=data_type,
            domain=domain,
            into={"Name": name, "Value": value},
        )
        return node.outputs[0]

    def switch(kind, chosen, no, yes):
        return add("GeometryNodeSwitch", chosen, no, yes, input_type=kind).outputs[0]

    mesh = add("GeometryNodeRealizeInstances", given["Geometry"]).outputs[0]
    normal = add("GeometryNodeInputNormal").outputs["Normal"]
    capture = add("GeometryNodeCaptureAttribute", mesh, domain="CORNER")
    capture.capture_items.new("VECTOR", "Normal")
    tree.links.new(normal, capture.inputs["Normal"])
    mesh = store(capture.outputs["Geometry"], FACE, index, "INT", "FACE")
    coarse = index + given["Faces"]
    mesh = store(mesh, LEVEL, sample(LEVEL, "INT", "POINT", coarse), "INT", "FACE")
    split = add("GeometryNodeTriangulate", mesh)
    tree.links.new(sample(SPLIT, "BOOLEAN", "POINT", coarse).socket, split.inputs["Selection"])
    mesh = split.outputs[0]
    join = add("GeometryNodeJoinGeometry")
    level = add("GeometryNodeInputNamedAttribute", LEVEL, data_type="INT").outputs["Attribute"]
    for each in range(LEVELS + 1):
        same = add("FunctionNodeCompare", level, each, data_type="INT", operation="EQUAL")
        part = add("GeometryNodeSeparateGeometry", mesh, same.outputs[0], domain="FACE")
        mesh = part.outputs["Inverted"]
        fine = add("GeometryNodeSubdivideMesh", part.outputs["Selection"], each)
        tree.links.new(fine.outputs[0], join.inputs[0])
    unit = Value(capture.outputs["Normal"]).normalize()
    shaped = add("GeometryNodeSetMeshNormal", join.outputs[0], mode="FREE", domain="CORNER")
    tree.links.new(unit.socket, shaped.inputs["Custom Normal"])
    clean = add("GeometryNodeRemoveAttribute", shaped.outputs[0], into={"Name": LEVEL})
    mesh = clean.outputs[0]

    then, now = (
        Value(
            add("GeometryNodeAttributeDomainSize", geometry, component="MESH").outputs[
                "Face Corner Count"
            ]
        )
        for geometry in (bake, mesh)
    )
    position = Value(add("GeometryNodeInputPosition").outputs[0])
    distance = position.distance(sample("position", "FLOAT_VECTOR", "CORNER", index))
    kept = add(
        "FunctionNodeBooleanMath",
        then.near(now, 0.5),
        distance.less_than(given["Near"]),
        operation="AND",
    ).outputs[0]

    key, level = (
        Value(add("ShaderNodeValue", name=each, label=each).outputs[0]) if moves else None
        for each in (KEY, SKY_LEVEL)
    )

    def moment(name, number):
        text = add("FunctionNodeValueToString", number).outputs[0]
        at = add("FunctionNodeReplaceString", at_key(name, "#"), "#", text).outputs[0]
        return Value(named(at, "FLOAT_VECTOR"))

    def light_of_day(name):
        """The mixture of two moments times the level, and what does not follow the sky."""
        part = key.fraction()
        first = key - part
        before, after = moment(name, first), moment(name, first + 1.0)
        steady = named(name, "FLOAT_COLOR")
        light = ((after - before) * part + before) * level + Value(steady)
        flag = add("FunctionNodeSeparateColor", steady).outputs["Alpha"]
        return add("FunctionNodeCombineColor", *light.xyz(), flag).outputs[0]

    def keep(mesh, name):
        moving = light_of_day(name) if moves else None
        value = sample(name, "FLOAT_COLOR", "CORNER", index, moving)
        value = switch("RGBA", kept, (0.0, 0.0, 0.0, 1.0), value)
        return store(mesh, name, value, "FLOAT_COLOR", "CORNER")

    mesh = keep(mesh, baked_light.LIGHT)
    both = keep(mesh, baked_light.BEHIND)
    add("NodeGroupOutput", switch("GEOMETRY", given["Back"], mesh, both))
