"""How far a picture is from the referee's: which pixels count, and what becomes of noise."""

from dataclasses import dataclass

import bpy
import numpy as np
from bands import S
from mathutils import Vector
from referee import Verdict
from reference import irradiance, pixel_means
from scipy.ndimage import binary_erosion, maximum_filter, minimum_filter, uniform_filter
from stage import Stage

from spectral_skylight.addon.transfer.measures import delta_E

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])

WINDOW = 5
"""Pixels: both pictures are means over this square of one and the same face before they are
compared. The referee's noise falls to a fifth; light that changes slowly stays what it is."""

HOW = (
    "CIEDE2000 on every pixel that shows one face and lies a pixel from its edge and two from a "
    f"shadow's edge; both pictures averaged over {WINDOW} x {WINDOW} pixels of that face; white: "
    "the perfect diffuser in that place (for metals facing up in the open). "
    "colour: the same with our luminance set to the referee's"
)


@dataclass(frozen=True)
class Rays:
    """What 4 x 4 rays a pixel meet: ``face`` (4h, 4w), -1 for the sky; ``lit`` (lamps, 4h, 4w).

    ``managed`` (4h, 4w): whether its material is one that the add-on was given.
    """

    face: np.ndarray
    lit: np.ndarray
    managed: np.ndarray


@dataclass(frozen=True)
class Pixels:
    """What of a picture is compared: ``face`` (h, w) counts the faces, -1 for none."""

    face: np.ndarray
    judged: np.ndarray
    white: np.ndarray
    left_out: float
    """Share of the surfaces' pixels that are not judged."""


def pixels(rays: Rays, stage: Stage, verdict: Verdict) -> Pixels:
    """Choose what is compared."""
    face = rays.face[2::4, 2::4]
    whole = pixel_means(rays.face == np.repeat(np.repeat(face, 4, 0), 4, 1)) == 1
    inside = np.zeros(face.shape, bool)
    for each in np.unique(face[face >= 0]):
        inside |= binary_erosion((face == each) & whole)
    judged = inside & rays.managed[2::4, 2::4]
    for lit in rays.lit:
        share = pixel_means(lit)
        # A pixel around the edge for its penumbra, and one for the pixels' filter.
        judged &= (minimum_filter(share, 5) == 1) | (maximum_filter(share, 5) == 0) | ~inside
    up = irradiance(stage.sky, np.array([[0.0, 0.0, 1.0]]))[0]
    if stage.sun is not None:
        up = up + stage.sun.spectrum * max(stage.sun.direction[2], 0.0) / np.pi
    matt = verdict.white @ LUMINANCE > 0
    white = np.where(matt[..., None], verdict.white, S @ up)
    return Pixels(face, judged, white, 1.0 - judged.sum() / max((face >= 0).sum(), 1))


def smoothed(picture: np.ndarray, where: Pixels) -> np.ndarray:
    """Return a picture whose judged pixels are means over those of the same face around them."""
    result = picture.astype(float).copy()
    for face in np.unique(where.face[where.judged]):
        mine = where.judged & (where.face == face)
        share = uniform_filter(mine.astype(float), WINDOW, mode="constant")
        for c in range(3):
            sums = uniform_filter(np.where(mine, picture[..., c], 0.0), WINDOW, mode="constant")
            result[..., c][mine] = sums[mine] / share[mine]
    return result


def error_map(picture: np.ndarray, true: np.ndarray, where: Pixels, colour=False) -> np.ndarray:
    """Return CIEDE2000 (h, w), NaN where nothing is judged; ``colour``: at the same luminance."""
    a, b, white = (smoothed(p, where)[where.judged] for p in (picture, true, where.white))
    if colour:
        a = a * ((b @ LUMINANCE) / np.maximum(a @ LUMINANCE, 1e-9))[:, None]
    result = np.full(where.judged.shape, np.nan)
    result[where.judged] = delta_E(a, b, white)
    return result


def figures(error: np.ndarray) -> dict[str, float]:
    """Return mean, 95th percentile and worst of a map."""
    found = error[np.isfinite(error)]
    return {
        "mean": float(found.mean()),
        "p95": float(np.percentile(found, 95)),
        "worst": float(found.max()),
    }


def noise(seeds: np.ndarray, where: Pixels) -> dict[str, float]:
    """Return what is left of chance in the mean of two seeds: half of what they differ by."""
    return figures(error_map(*seeds, where) / 2)


def bounced(verdict: Verdict, where: Pixels) -> float:
    """Return what part of the light has bounced, as a mean over what is judged and matt."""
    matt = where.judged & (verdict.white @ LUMINANCE > 0)
    direct, white = (image[matt] @ LUMINANCE for image in (verdict.direct, verdict.white))
    return float(np.mean(1.0 - direct / white)) if matt.any() else 0.0


def errors(picture: np.ndarray, verdict: Verdict, where: Pixels) -> dict[str, dict]:
    """Return the figures of a picture's errors, and of its colour's alone."""
    return {
        name: figures(error_map(picture, verdict.spectral, where, alone))
        for name, alone in (("delta_E", False), ("colour", True))
    }


def cast(stage: Stage) -> Rays:
    """Look at the open scene along every ray, and from there to the sun and the lamps.

    A ball is one face. A ray goes on behind panes, and what it meets there counts apart.
    """
    panes = {
        name
        for name, thing in stage.things.items()
        if stage.matter[thing.matter].transmittance is not None
    }
    given = {
        name
        for name, thing in stage.things.items()
        if not (m := stage.matter[thing.matter]).unmanaged and m.emission is None
    }
    balls = {name for name, thing in stage.things.items() if thing.ball}
    depsgraph = bpy.context.evaluated_depsgraph_get()

    def first(origin: Vector, direction: Vector, far: float = 1e6):
        behind = 0
        while True:
            found = bpy.context.scene.ray_cast(depsgraph, origin, direction, distance=far)
            if not found[0] or found[4].name not in panes:
                return *found, behind
            behind += 1
            origin = found[1] + direction * 1e-4

    suns = [Vector(stage.sun.direction) * 1e4] if stage.sun is not None else []
    lights = [*suns, *(Vector(lamp.location) for lamp in stage.lamps.values())]
    origins, directions = stage.camera.rays(4)
    known: dict[tuple, int] = {}
    face = np.full(origins.shape[:2], -1)
    lit = np.zeros((len(lights), *face.shape), bool)
    managed = np.zeros(face.shape, bool)
    for at in np.ndindex(face.shape):
        hit, place, normal, index, thing, _, behind = first(
            Vector(origins[at]), Vector(directions[at])
        )
        if not hit:
            continue
        key = thing.name, 0 if thing.name in balls else index, behind
        managed[at] = thing.name in given
        face[at] = known.setdefault(key, len(known))
        place = place + normal * 1e-4
        for k, light in enumerate(lights):
            way = light - place
            lit[k][at] = not first(place, way.normalized(), way.length)[0]
    return Rays(face, lit, managed)
