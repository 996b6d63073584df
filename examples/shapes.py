"""Shapes as quads, corners counter-clockwise from outside. Metres; x east, y north, z up."""

Quads = list[list[tuple[float, float, float]]]


def box(x0, y0, z0, x1, y1, z1) -> Quads:
    """Return the five faces of a box that stands on something, outwards."""
    a, b, c, d = (x0, y0), (x1, y0), (x1, y1), (x0, y1)
    sides = [[(*p, z0), (*q, z0), (*q, z1), (*p, z1)] for p, q in ((a, b), (b, c), (c, d), (d, a))]
    return [*sides, [(*p, z1) for p in (a, b, c, d)]]


def slab(x0, y0, z0, x1, y1, z1) -> Quads:
    """Return all six faces of a box, outwards."""
    return [*box(x0, y0, z0, x1, y1, z1), *down(x0, y0, x1, y1, z0)]


def level(x0, y0, x1, y1, z=0.0) -> Quads:
    """Return a face that looks up."""
    return [[(x0, y0, z), (x1, y0, z), (x1, y1, z), (x0, y1, z)]]


def down(x0, y0, x1, y1, z) -> Quads:
    """Return a face that looks down."""
    return [[(x0, y1, z), (x1, y1, z), (x1, y0, z), (x0, y0, z)]]


def south(x0, x1, z0, z1, y) -> Quads:
    """Return an upright face that looks south."""
    return [[(x0, y, z0), (x1, y, z0), (x1, y, z1), (x0, y, z1)]]


def north(x0, x1, z0, z1, y) -> Quads:
    """Return an upright face that looks north."""
    return [[(x1, y, z0), (x0, y, z0), (x0, y, z1), (x1, y, z1)]]


def east(y0, y1, z0, z1, x) -> Quads:
    """Return an upright face that looks east."""
    return [[(x, y0, z0), (x, y1, z0), (x, y1, z1), (x, y0, z1)]]


def west(y0, y1, z0, z1, x) -> Quads:
    """Return an upright face that looks west."""
    return [[(x, y1, z0), (x, y0, z0), (x, y0, z1), (x, y1, z1)]]


def framed(face, opening, wall: tuple[float, float, float, float], at: float) -> Quads:
    """Return a wall around an opening, as four faces.

    ``face``: one of the upright shapes; ``opening``, ``wall``: (from, to, bottom, top); ``at``:
    where its plane is.
    """
    a, b, z0, z1 = wall
    c, d, y0, y1 = opening
    parts = (a, c, z0, z1), (d, b, z0, z1), (c, d, z0, y0), (c, d, y1, z1)
    return [
        quad
        for part in parts
        if part[0] < part[1] and part[2] < part[3]
        for quad in face(*part, at)
    ]
