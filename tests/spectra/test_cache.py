"""What is kept on disk is used whole or not at all, and nobody needs a place to keep it."""

import os
import subprocess
import sys

import numpy as np
import pytest

from spectral_skylight.addon.spectra import cache

ARRAYS = {"a": np.arange(6.0).reshape(2, 3), "b": np.array([1, 2], np.uint8)}


def test_what_is_kept_comes_back(tmp_path):
    path = tmp_path / "kept" / "x.npz"
    cache.save(path, ARRAYS)
    found = cache.load(path)
    assert found.keys() == ARRAYS.keys()
    assert all(np.array_equal(found[name], ARRAYS[name]) for name in ARRAYS)


def test_damage_of_any_kind_is_as_nothing(tmp_path):
    """Each bit that is turned, each end that is lost, and a whole file of another content."""
    path = tmp_path / "x.npz"
    cache.save(path, ARRAYS)
    content = path.read_bytes()
    for place in range(len(content)):
        for bit in (0, 7):
            path.write_bytes(bytes(b ^ (k == place) << bit for k, b in enumerate(content)))
            found = cache.load(path)
            assert found is None or all(np.array_equal(found[k], v) for k, v in ARRAYS.items())
    for end in range(len(content)):
        path.write_bytes(content[:end])
        assert cache.load(path) is None
    for arrays in ({}, {"a": ARRAYS["a"]}, {**ARRAYS, "digest": ARRAYS["b"]}):
        np.savez(path, **arrays)
        assert cache.load(path) is None


@pytest.mark.skipif(os.name == "nt", reason="Windows has no such users")
def test_who_has_no_home_has_no_cache():
    code = (
        "import pwd\ndef none(_): raise KeyError\npwd.getpwuid = none\n"
        "from spectral_skylight.addon.spectra import cache; print(cache.folder())"
    )
    nobody = {k: v for k, v in os.environ.items() if k not in ("HOME", "XDG_CACHE_HOME")}
    nobody.pop("SPECTRAL_SKYLIGHT_CACHE", None)
    for more, said in (({}, "None"), ({"HOME": "/h"}, "/h/.cache/spectral-skylight")):
        done = subprocess.run(
            [sys.executable, "-c", code], env={**nobody, **more}, capture_output=True, text=True
        )
        assert done.stdout.strip() == said, done.stderr
