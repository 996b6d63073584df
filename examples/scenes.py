"""The main job's two scenes: the checker's 24 surfaces, each alone, and a building."""

import numpy as np
from geometry import (
    BUILDING_CAMERA,
    BUILDING_MATERIALS,
    CHECKER_CAMERA,
    SPHERE_RADIUS,
    building,
    sphere_centres,
)
from stage import Matter, Stage, Thing


def checker_stage(reflectances: dict[str, np.ndarray], sky: np.ndarray | None) -> Stage:
    """Return a sphere of each reflectance (81,) under a sky (h, 2h, 81)."""
    things = {
        name: Thing(name, ball=(tuple(centre), SPHERE_RADIUS))
        for name, centre in zip(reflectances, sphere_centres(), strict=True)
    }
    matter = {name: Matter(rho) for name, rho in reflectances.items()}
    return Stage(things, matter, sky, CHECKER_CAMERA)


def building_stage(reflectances: dict[str, np.ndarray], sky: np.ndarray | None) -> Stage:
    """Return the building, each part of the reflectance (81,) that `BUILDING_MATERIALS` says."""
    things = {part: Thing(part, polygons) for part, polygons in building().items()}
    matter = {part: Matter(reflectances[name]) for part, name in BUILDING_MATERIALS.items()}
    return Stage(things, matter, sky, BUILDING_CAMERA)
