"""What is done to a scene, a function each: buttons, commands and batch tasks call these.

Those that take long are generators of `Progress`: `run` works one to its end, and whoever closes
one leaves things whole. Each returns what to report.
"""

from .light import (
    all_light,
    bake,
    chosen_light,
    following,
    light_lines,
    making_spectral_with_all_light,
)
from .materials import (
    editable,
    estimate,
    give_table,
    given_before,
    in_scene,
    left_alone,
    make_everything_spectral,
    make_spectral,
    making_spectral,
    remove,
    remove_all,
    resolved,
    update,
    updating,
    write_table,
)
from .meter import exposure, light_on_surfaces, measuring, picture_of_light, surveying
from .sky import animate, load_sky, loading_sky, showing_sky, simulate_sky, simulating_sky
from .world import analyzed, develop, developing, set_sky, setting_sky, with_estimated_white

__all__ = [
    "all_light",
    "analyzed",
    "animate",
    "bake",
    "chosen_light",
    "develop",
    "developing",
    "editable",
    "estimate",
    "exposure",
    "following",
    "give_table",
    "given_before",
    "in_scene",
    "left_alone",
    "light_lines",
    "light_on_surfaces",
    "load_sky",
    "loading_sky",
    "make_everything_spectral",
    "make_spectral",
    "making_spectral",
    "making_spectral_with_all_light",
    "measuring",
    "picture_of_light",
    "remove",
    "remove_all",
    "resolved",
    "set_sky",
    "setting_sky",
    "showing_sky",
    "simulate_sky",
    "simulating_sky",
    "surveying",
    "update",
    "updating",
    "with_estimated_white",
    "write_table",
]
