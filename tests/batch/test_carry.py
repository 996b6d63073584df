"""Images of a scene travel with it; what is no image stays at home, whatever it is called."""

import bpy
import numpy as np
import pytest

from spectral_skylight.addon.batch.carry import carry
from spectral_skylight.tests import faces

pytestmark = pytest.mark.blender

KINDS = {"PNG": "png", "JPEG": "jpg", "TARGA": "tga", "BMP": "bmp", "OPEN_EXR": "exr", "HDR": "hdr",
         "TIFF": "tif", "WEBP": "webp", "IRIS": "rgb", "DPX": "dpx"}  # fmt: skip
SECRET = "-----BEGIN OPENSSH PRIVATE KEY-----\nb3BlbnNzaC1rZXktdjEAAAAABG5vbmUAAAAEbm9uZQ\n" * 40


def used(path):
    """An image of the open file that reads a path, whatever is there."""
    image = bpy.data.images.new(path.stem, 4, 4)
    image.source, image.filepath = "FILE", str(path)
    image.use_fake_user = True
    return image


@pytest.fixture
def folder(tmp_path):
    faces.empty_scene()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "house.blend"))
    (tmp_path / "out").mkdir()
    return tmp_path


@pytest.mark.parametrize("kind", KINDS)
def test_images_of_any_kind_are_copied(folder, kind):
    path = folder / f"brick.{KINDS[kind]}"
    made = bpy.data.images.new("made", 8, 8)
    made.pixels = np.tile([0.2, 0.5, 0.7, 1.0], 64).tolist()
    made.file_format, made.filepath_raw = kind, str(path)
    made.save()
    image = used(path)
    assert carry(image, folder / "out") == ""
    (copy,) = (folder / "out").iterdir()
    assert copy.read_bytes() == path.read_bytes() and copy.suffix == path.suffix
    assert carry(image, folder / "out") == "" and len(list((folder / "out").iterdir())) == 1


@pytest.mark.parametrize("name", ["id_rsa", "id_rsa.png", "accounts.tga", "x.exr", ".env", "m.bmp"])
@pytest.mark.parametrize(
    "text", [SECRET, "", "BMW: 17\n", "\x00\x00\x02 secrets", "[default]\nkey=1"]
)
def test_what_is_no_image_is_not_copied_and_told(folder, name, text):
    path = folder / name
    path.write_text(text)
    line = carry(used(path), folder / "out")
    assert "is no image and not copied" in line and str(path) in line
    assert list((folder / "out").iterdir()) == []


def test_the_longest_names_are_shortened(folder):
    path = folder / f"{'é' * 110}.png"
    made = bpy.data.images.new("made", 8, 8)
    made.file_format, made.filepath_raw = "PNG", str(folder / "a.png")
    made.save()
    (folder / "a.png").rename(path)
    assert carry(used(path), folder / "out") == ""
    (copy,) = (folder / "out").iterdir()
    assert len(copy.name.encode()) < 130
