"""`Sky Bake`: the last modifier of a baked object, which gives its corners what was baked for them.

The user's mesh stays as it is. What arrives from the modifiers before (instances made real, for one
bake holds one place each) is subdivided face by face, as finely as the light needs, without moving
the surface or its normals; then each corner takes the bake's values of the same number. Where
the geometry is no longer what was baked, by count or place of a corner, the flag stays 0, and the
material falls back to the open sky.

The bake is a mesh object of ours that no scene holds: its faces are the subdivided ones, their
vertices split where normals are, so that a value lies there once; loose vertices after them hold a
number for each face before subdivision.
"""

from __future__ import annotations

from functools import partial

import bpy

from . import sky_visibility
from . import tree as groups

KIND = "Sky Bake"
VERSION = 2
LEVELS = 7  # a face of four corners then has 128 x 128 cells
LEVEL = "skylight_level"  # on a loose vertex: how often its face is halved
SPLIT = "skylight_split"  # … whether it is triangulated first
FACE = "skylight_face"  # on the subdivided faces: the number of the face before
NEAR = 1e-4  # how far a corner may lie from where it was baked, of the object's size

SOCKETS = [
    ("Geometry", "NodeSocketGeometry"),
    ("Bake", "NodeSocketObject"),
    ("Faces", "NodeSocketInt"),
    ("Near", "NodeSocketFloat"),
    ("Bounce", "NodeSocketBool"),
    ("Back", "NodeSocketBool"),
]


def ensure() -> bpy.types.NodeTree:
    """The `Sky Bake` group of this file, made or updated.

    Inputs: Geometry; Bake, the object; Faces, the number of its first loose vertex; Near [object
    units]; Bounce, whether attributes 5 to 9 are wanted; Back, whether those of backs.
    Output: Geometry.
    """
    tree = groups.known(KIND, VERSION)
    if tree is None:
        tree = bpy.data.node_groups.new(KIND, "GeometryNodeTree")
        tree[groups.KIND] = KIND
        tree.is_modifier = True
    inputs = [(name, kind, None) for name, kind in SOCKETS]
    return groups.ensure(
        tree, KIND, VERSION, inputs, [("Geometry", "NodeSocketGeometry", None)], _build
    )


def _build(tree: bpy.types.NodeTree) -> None:
    add = partial(groups.add, tree)
    link = tree.links.new
    given = add("NodeGroupInput").outputs
    info = add("GeometryNodeObjectInfo", transform_space="ORIGINAL")
    link(given["Bake"], info.inputs["Object"])
    bake = info.outputs["Geometry"]
    index = add("GeometryNodeInputIndex").outputs[0]

    def sample(name, data_type, domain, at):
        named = add("GeometryNodeInputNamedAttribute", name, data_type=data_type)
        node = add("GeometryNodeSampleIndex", bake, data_type=data_type, domain=domain)
        link(named.outputs["Attribute"], node.inputs["Value"])
        link(at, node.inputs["Index"])
        return node.outputs["Value"]

    def store(geometry, name, value, data_type, domain):
        node = add("GeometryNodeStoreNamedAttribute", geometry, data_type=data_type, domain=domain)
        node.inputs["Name"].default_value = name
        link(value, node.inputs["Value"])
        return node.outputs[0]

    def switch(kind, chosen, no, yes):
        node = add("GeometryNodeSwitch", input_type=kind)
        link(chosen, node.inputs["Switch"])
        for name, source in (("False", no), ("True", yes)):
            if isinstance(source, bpy.types.NodeSocket):
                link(source, node.inputs[name])
            else:
                node.inputs[name].default_value = source
        return node.outputs[0]

    mesh = add("GeometryNodeRealizeInstances", given["Geometry"]).outputs[0]
    normal = add("GeometryNodeInputNormal").outputs["Normal"]
    capture = add("GeometryNodeCaptureAttribute", mesh, domain="CORNER")
    capture.capture_items.new("VECTOR", "Normal")
    link(normal, capture.inputs["Normal"])
    mesh = store(capture.outputs["Geometry"], FACE, index, "INT", "FACE")
    coarse = add("ShaderNodeMath", index, given["Faces"], operation="ADD").outputs[0]
    mesh = store(mesh, LEVEL, sample(LEVEL, "INT", "POINT", coarse), "INT", "FACE")
    split = add("GeometryNodeTriangulate", mesh)
    link(sample(SPLIT, "BOOLEAN", "POINT", coarse), split.inputs["Selection"])
    mesh = split.outputs[0]
    join = add("GeometryNodeJoinGeometry")
    level = add("GeometryNodeInputNamedAttribute", LEVEL, data_type="INT").outputs["Attribute"]
    for each in range(LEVELS + 1):
        same = add("FunctionNodeCompare", data_type="INT", operation="EQUAL")
        first, second = (s for s in same.inputs if s.type == "INT" and s.enabled)
        link(level, first)
        second.default_value = each
        part = add("GeometryNodeSeparateGeometry", mesh, same.outputs[0], domain="FACE")
        mesh = part.outputs["Inverted"]
        fine = add("GeometryNodeSubdivideMesh", part.outputs["Selection"], each)
        link(fine.outputs[0], join.inputs[0])
    unit = add("ShaderNodeVectorMath", capture.outputs["Normal"], operation="NORMALIZE")
    shaped = add("GeometryNodeSetMeshNormal", join.outputs[0], mode="FREE", domain="CORNER")
    link(unit.outputs[0], shaped.inputs["Custom Normal"])
    clean = add("GeometryNodeRemoveAttribute", shaped.outputs[0])
    clean.inputs["Name"].default_value = LEVEL
    mesh = clean.outputs[0]

    counts = []
    for geometry in (bake, mesh):
        size = add("GeometryNodeAttributeDomainSize", geometry, component="MESH")
        counts.append(size.outputs["Face Corner Count"])
    distance = add(
        "ShaderNodeVectorMath",
        add("GeometryNodeInputPosition").outputs[0],
        sample("position", "FLOAT_VECTOR", "CORNER", index),
        operation="DISTANCE",
    ).outputs["Value"]
    kept = add(
        "FunctionNodeBooleanMath",
        add("ShaderNodeMath", *counts, 0.5, operation="COMPARE").outputs[0],
        add("ShaderNodeMath", distance, given["Near"], operation="LESS_THAN").outputs[0],
        operation="AND",
    ).outputs[0]

    def keep(mesh, name):
        value = sample(name, "FLOAT_COLOR", "CORNER", index)
        value = switch("RGBA", kept, (0.0, 0.0, 0.0, 1.0), value)
        return store(mesh, name, value, "FLOAT_COLOR", "CORNER")

    for name in (*map(sky_visibility.attribute, range(5)), sky_visibility.EXACT):
        mesh = keep(mesh, name)
    mesh = switch("GEOMETRY", given["Back"], mesh, keep(mesh, sky_visibility.BACK))
    bounced = mesh
    for number in range(5, 10):
        bounced = keep(bounced, sky_visibility.attribute(number))
    add("NodeGroupOutput", switch("GEOMETRY", given["Bounce"], mesh, bounced))
    groups.arrange(tree)
