"""Arithmetic in a node tree: `Value` is the number or the vector that a socket gives.

    normal.dot((0.0, 0.0, 1.0)) * 0.5 + 0.5

adds a Dot Product, a Multiply and an Add node, in the order in which Python evaluates them.
"""

from __future__ import annotations

from typing import Any

from bpy.types import Node, NodeSocket, NodeTree

from . import tree as groups

VECTORS = ("VECTOR", "RGBA")  # types of sockets that hold three numbers, a color's alpha aside


class Value:
    """What a socket gives: a number or a vector.

    Each operator and method adds one node and returns its output. The other operands are a Value, a
    number, or three numbers. A vector among the operands makes it a Vector Math node, any other is
    a Math node. A vector times a number is scaled; elsewhere a linked number stands for three.
    """

    def __init__(self, socket: NodeSocket) -> None:
        self.socket = socket

    def __add__(self, other: Any) -> Value:
        return self._op("ADD", self, other)

    def __sub__(self, other: Any) -> Value:
        return self._op("SUBTRACT", self, other)

    def __rsub__(self, other: Any) -> Value:
        return self._op("SUBTRACT", other, self)

    def __mul__(self, other: Any) -> Value:
        scaled = _is_vector(self) and not _is_vector(other)
        return self._op("SCALE" if scaled else "MULTIPLY", self, other)

    def __truediv__(self, other: Any) -> Value:
        return self._op("DIVIDE", self, other)

    def __rtruediv__(self, other: Any) -> Value:
        return self._op("DIVIDE", other, self)

    def __pow__(self, other: Any) -> Value:
        return self._op("POWER", self, other)

    def __abs__(self) -> Value:
        return self._op("ABSOLUTE", self)

    def multiply_add(self, factor: Any, addend: Any) -> Value:
        """This times a factor, plus an addend, as one node."""
        return self._op("MULTIPLY_ADD", self, factor, addend)

    def minimum(self, other: Any) -> Value:
        """The lesser of the two, for a vector in each channel."""
        return self._op("MINIMUM", self, other)

    def maximum(self, other: Any) -> Value:
        """The greater of the two, for a vector in each channel."""
        return self._op("MAXIMUM", self, other)

    def clamp(self) -> Value:
        """This number held between 0 and 1, by the Math node that gives it; so it adds none."""
        self.socket.node.use_clamp = True
        return self

    def sqrt(self) -> Value:
        """The square root of a number."""
        return self._op("SQRT", self)

    def exp(self) -> Value:
        """e to the power of a number."""
        return self._op("EXPONENT", self)

    def fraction(self) -> Value:
        """What a number has after the point."""
        return self._op("FRACT", self)

    def less_than(self, other: Any) -> Value:
        """1 where a number is less than the other, else 0."""
        return self._op("LESS_THAN", self, other)

    def greater_than(self, other: Any) -> Value:
        """1 where a number is greater than the other, else 0."""
        return self._op("GREATER_THAN", self, other)

    def near(self, other: Any, distance: float, **settings: Any) -> Value:
        """1 where a number is no farther than a distance from the other, else 0."""
        return math(self.socket.id_data, "COMPARE", self, other, distance, **settings)

    def dot(self, other: Any, **settings: Any) -> Value:
        """The scalar product of two vectors."""
        return vector_math(self.socket.id_data, "DOT_PRODUCT", self, other, **settings)

    def distance(self, other: Any) -> Value:
        """The length of the difference of two vectors."""
        return vector_math(self.socket.id_data, "DISTANCE", self, other)

    def normalize(self) -> Value:
        """The vector of length 1 in this direction; 0 stays 0."""
        return vector_math(self.socket.id_data, "NORMALIZE", self)

    def xyz(self) -> tuple[Value, Value, Value]:
        """The three numbers of a vector."""
        return _split(groups.add(self.socket.id_data, "ShaderNodeSeparateXYZ", self))

    def rgb(self) -> tuple[Value, Value, Value]:
        """The red, green and blue of a color."""
        return _split(groups.add(self.socket.id_data, "ShaderNodeSeparateColor", self, mode="RGB"))

    def _op(self, operation: str, *operands: Any) -> Value:
        made_by = vector_math if any(map(_is_vector, operands)) else math
        return made_by(self.socket.id_data, operation, *operands)


def math(tree: NodeTree, operation: str, *operands: Any, **settings: Any) -> Value:
    """What a new Math node gives; an operand that is None stays as the node has it."""
    node = groups.add(tree, "ShaderNodeMath", *operands, operation=operation, **settings)
    return Value(node.outputs[0])


def vector_math(tree: NodeTree, operation: str, *operands: Any, **settings: Any) -> Value:
    """What a new Vector Math node gives; an operand that is None stays as the node has it."""
    node = groups.add(tree, "ShaderNodeVectorMath", *operands, operation=operation, **settings)
    return Value(next(socket for socket in node.outputs if socket.enabled))


def combine_xyz(x: Value, y: Value, z: Value) -> Value:
    """The vector of three numbers."""
    return Value(groups.add(x.socket.id_data, "ShaderNodeCombineXYZ", x, y, z).outputs[0])


def combine_rgb(red: Value, green: Value, blue: Value) -> Value:
    """The color of three numbers."""
    tree = red.socket.id_data
    node = groups.add(tree, "ShaderNodeCombineColor", red, green, blue, mode="RGB")
    return Value(node.outputs[0])


def outputs(node: Node) -> dict[str, Value]:
    """What each output of a node gives, by its name."""
    return {socket.name: Value(socket) for socket in node.outputs}


def inputs(tree: NodeTree) -> dict[str, Value]:
    """What each input of a group gives inside of it, by its name: adds a Group Input node."""
    return outputs(groups.add(tree, "NodeGroupInput"))


def _is_vector(operand: Any) -> bool:
    if isinstance(operand, Value):
        return operand.socket.type in VECTORS
    return isinstance(operand, tuple)


def _split(node: Node) -> tuple[Value, Value, Value]:
    first, second, third = (Value(socket) for socket in node.outputs)
    return first, second, third
