"""What of a study can be told without Blender: read, and every mistake named with its cure."""

import pytest

from spectral_skylight.addon.batch.study import read_study
from spectral_skylight.addon.errors import InputError
from spectral_skylight.tests.batch.studies import NOON, write_inputs, write_study


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "house.blend").touch()
    return write_inputs(tmp_path)


def test_everything_is_read(folder):
    study = read_study(
        write_study(
            folder,
            skies=["sky.exr", {**NOON, "times": ["09:00", "12:30"], "north": 15}],
            variants=[{"name": "a", "assign": "red.csv"}, {"name": "b", "assign": "grey.csv"}],
            cameras=["South", "Court"],
            frames=[1, 5],
        )
    )
    assert study.out == folder / "out" and study.scenes == (folder / "house.blend",)
    assert study.cameras == ("South", "Court") and study.frames == (1, 5)
    assert [sky.name for sky in study.skies] == ["sky", "2025-06-21_0900", "2025-06-21_1230"]
    assert study.skies[0].north is None and study.skies[1].north == 15
    assert [variant.given["Wall"].name for variant in study.variants] == ["red", "grey"]
    assert (study.engine, study.samples, study.resolution) == ("cycles", 1, (16, 16))


def test_summer_time_counts(folder):
    """Noon of 21 June in Berlin's summer time is 10:00 UTC: NOAA's calculator has 55.0° then."""
    skies = [NOON, {**NOON, "timezone": "UTC", "times": ["10:00"]}, {**NOON, "timezone": 1}]
    summer, utc, winter = (sky.sun for sky in read_study(write_study(folder, skies=skies)).skies)
    assert summer == pytest.approx(utc)
    assert winter[1] - summer[1] > 20  # an hour later, and farther west


def test_a_city_is_a_place_and_its_time_zone(folder):
    munich = {"date": "2025-06-21", "times": ["12:00"], "city": "munich", "north": 0}
    skies = [munich, NOON, {**munich, "timezone": 1}]
    named, given, winter = (sky.sun for sky in read_study(write_study(folder, skies=skies)).skies)
    assert named == pytest.approx(given, abs=0.1)  # degrees; the two places are 5 km apart
    assert winter[1] - named[1] > 20  # as in `test_summer_time_counts`


def test_toml_dates_and_times_without_quotes(folder):
    path = write_study(folder, skies=[NOON])
    text = path.read_text().replace('"2025-06-21"', "2025-06-21").replace('"12:00"', "12:00:00")
    assert "2025-06-21," in text
    sky = read_study(path).skies[0]
    path.write_text(text)
    assert read_study(path).skies[0] == sky


def test_a_variant_names_glass_metal_panes_and_estimates(folder):
    metal = "".join(f"{nm},{0.2 + nm / 4000},{2 + nm / 500}\n" for nm in range(380, 781, 20))
    (folder / "gold.csv").write_text("nm,n,k\n" + metal)
    (folder / "parts.csv").write_text(
        "material,reflectance,glass,metal,behind,pane\n"
        "Wall,paint.csv:red,,,paint.csv:grey,\n"
        "Pane,,paint.csv:grey,,,block\n"
        "Handle,,,gold.csv,,\n"
        "Floor,estimate,,,,\n"
    )
    study = read_study(write_study(folder, variants=[{"name": "x", "assign": "parts.csv"}]))
    given = study.variants[0].given
    assert given["Floor"] is None and given["Wall"].name == "red behind grey"
    assert given["Pane"].faces == 2 and given["Handle"].metal is not None
    # Another pane is another variant: its pictures are made anew.
    text = (folder / "parts.csv").read_text().replace(",block", ",face")
    (folder / "parts.csv").write_text(text)
    again = read_study(write_study(folder, variants=[{"name": "x", "assign": "parts.csv"}]))
    assert again.variants[0].content != study.variants[0].content


def test_a_reflectance_is_found_beside_the_assignment_or_the_study(folder):
    inner = folder / "variants"
    inner.mkdir()
    (inner / "red.csv").write_text(
        "# ours\nmaterial;reflectance\nWall;own.csv:red\nDoor;paint.csv:grey"
        "\nFloor;colour:BabelColor Average:dark skin"
    )
    (inner / "own.csv").write_text((folder / "paint.csv").read_text())
    study = read_study(write_study(folder, variants=[{"name": "x", "assign": "variants/red.csv"}]))
    assert {m: one.name for m, one in study.variants[0].given.items()} == {
        "Wall": "red",
        "Door": "grey",
        "Floor": "dark skin",
    }


CITY = {"date": "2025-06-21", "times": ["12:00"], "city": "Bonn", "north": 0}

MISTAKES = {
    "unknown key": ({"camera": "all"}, ['"camera"', 'did you mean "cameras"']),
    "no out": ({"out": None}, ['"out"', "missing"]),
    "no such scene": ({"scenes": ["hous.blend"]}, ["hous.blend"]),
    "no such sky": ({"skies": ["none.exr"]}, ["skies 1", "none.exr"]),
    "sky that is none": ({"skies": ["paint.csv"]}, ["paint.csv"]),
    "sky cut short": ({"skies": ["cut.exr"]}, ["cut.exr", "cut short"]),
    "sky key": ({"skies": [{**NOON, "lattitude": 3}]}, ["skies 1", 'did you mean "latitude"']),
    "no zone": ({"skies": [{**NOON, "timezone": "Europe/Berln"}]}, ["skies 1", "Europe/Berln"]),
    "zone left out": (
        {"skies": [{k: v for k, v in NOON.items() if k != "timezone"}]},
        ["timezone"],
    ),
    "no such city": ({"skies": [CITY | {"city": "Oz"}]}, ["skies 1", '"city"', "'Oz' is not in"]),
    "city and place": ({"skies": [{**NOON, **CITY}]}, ["skies 1", 'leave "latitude" and "long']),
    "city beside a file": ({"skies": [{"file": "sky.exr", "city": "Bonn"}]}, ['"city"', "beside"]),
    "north left out": ({"skies": [{k: v for k, v in NOON.items() if k != "north"}]}, ["north"]),
    "no time": ({"skies": [{**NOON, "times": ["25:00"]}]}, ["25:00"]),
    "time that a clock skips": (
        {"skies": [{**NOON, "date": "2025-03-30", "times": ["02:30"]}]},
        ["02:30", "summer time"],
    ),
    "time that a clock has twice": (
        {"skies": [{**NOON, "date": "2025-10-26", "times": ["02:30"]}]},
        ["02:30 comes twice", '"times"', 'give "timezone" in hours, +2:00 or +1:00'],
    ),
    "night": ({"skies": [{**NOON, "times": ["23:50"]}]}, ["2025-06-21 23:50", "below the horizon"]),
    "no such assignment": ({"variants": [{"name": "x", "assign": "blue.csv"}]}, ["blue.csv"]),
    "assignment without columns": (
        {"variants": [{"name": "x", "assign": "paint.csv"}]},
        ["paint.csv", '"material"'],
    ),
    "no such column": ({"variants": [{"name": "x", "assign": "blue column.csv"}]}, ["blue", "red"]),
    "variant twice": ({"variants": [{"name": "x"}, {"name": "x"}]}, ["variants", "twice"]),
    "engine": ({"engine": "workbench"}, ["workbench", "eevee or cycles"]),
    "samples": ({"samples": 0}, ["samples"]),
    "resolution": ({"resolution": [16]}, ["resolution"]),
    "bounce without a bake": ({"bounce": True, "occlusion": "open"}, ["occlusion"]),
    "white": ({"white": [1, 1]}, ["white"]),
}


@pytest.mark.parametrize(("changes", "parts"), MISTAKES.values(), ids=MISTAKES.keys())
def test_mistakes_are_one_line_with_place_and_cure(folder, changes, parts):
    (folder / "cut.exr").write_bytes((folder / "sky.exr").read_bytes()[:-400])
    (folder / "blue column.csv").write_text("material,reflectance\nWall,paint.csv:blue")
    with pytest.raises(InputError) as caught:
        read_study(write_study(folder, **changes))
    message = str(caught.value)
    assert "\n" not in message
    assert all(part in message for part in parts), message


def test_no_toml_names_line_and_column(folder):
    path = folder / "study.toml"
    path.write_text('out = "out"\nscenes = house.blend\n')
    with pytest.raises(InputError, match=r"study\.toml.*line 2, column 10"):
        read_study(path)


def test_a_folder_that_cannot_be_written_to_is_told_at_once(folder):
    (folder / "out").write_text("a file, where a folder should be")
    with pytest.raises(InputError, match="out.*cannot be written to"):
        read_study(write_study(folder))
