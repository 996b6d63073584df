"""Every kind of file gives the curve that was written into it, or says in a line why not."""

import numpy as np
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.spectra.curves import NoSpectra
from spectral_skylight.addon.spectra.grid import WAVELENGTHS
from spectral_skylight.addon.spectra.reflectance import read_all, read_one, read_reflectances
from spectral_skylight.addon.spectra.text_encodings import national
from spectral_skylight.tests.spectra import kind_files, kinds
from spectral_skylight.tests.spectra.kind_files import GREY, NM, PERCENT, RED, red, rows, text


@pytest.fixture
def write(tmp_path):
    def write(name, content):
        path = tmp_path / name
        path.write_bytes(content)
        return path

    return write


def assert_red(values, atol=2e-4):
    """Rows of 10 nm are joined by cubics: a curve's own bends are off by less than this."""
    seen = (WAVELENGTHS >= 400) & (WAVELENGTHS <= 700)
    np.testing.assert_allclose(values[seen], red(WAVELENGTHS)[seen], atol=atol)


@pytest.mark.parametrize(("name", "content"), kinds.KNOWN.values(), ids=kinds.KNOWN.keys())
def test_known_kinds(write, name, content):
    read = read_reflectances(write(name, content))
    # In steps of 10 nm a cubic cuts the corners where red begins.
    assert_red(read.values[0], atol=1.5e-3)
    kind = read.kinds[0]
    assert len(read.kinds) == len(read.names) and kind.format and kind.unit
    assert kind.quantity in ("", "reflectance", "absorbance", "log(1/R)", "Kubelka-Munk")


def named(write, kind):
    return read_reflectances(write(*kinds.KNOWN[kind]))


def test_names_are_those_that_people_gave(write):
    told = {
        "spreadsheet, quoted names": ("Red, matt",),
        "spreadsheet, two headings": ("Red",),
        "spreadsheet, names over quantities": ("Red",),
        "spreadsheet, a title": ("Red",),
        "remarks beside it": ("red",),
        "R, row names": ("red",),
        "R, rows are samples": ("1", "2"),
        "rows are samples, Konica Minolta": ("Red",),
        "Cary": ("Red", "Grey"),
        "pairs without headings": ("a 1", "a 3"),
        "rows are samples, with and without gloss": ("Red SCI", "Red SCE"),
        "names over dates over quantities": ("Red",),
        "Spectra Vista": ("Reflectance %",),
        "QTX": ("Red", "Grey"),
        "CxF2": ("Red",),
        "TM-27": ("Red",),
        "CGATS, names with blanks": ("Dark red", "Red 2"),
        "CGATS, names with blanks between blanks": ("Dark red 2",),
        "SQZ": ("RED",),
        "renderer": ("a",),
    }
    assert {kind: named(write, kind).names for kind in told} == told


def test_what_was_read_is_said(write):
    said = {
        "AvaSoft 7": ("text in columns", "reflectance", "percent"),
        "Jasco": ("text in columns", "reflectance", "percent"),
        "absorbance": ("CSV", "absorbance", "fraction"),
        "rows are samples, Konica Minolta": ("CSV, samples in rows", "", "percent"),
        "SQZ": ("JCAMP-DX", "reflectance", "fraction"),
        "QTX": ("Datacolor QTX", "reflectance", "percent"),
        "CGATS, a norm of 30": ("CGATS", "", "fraction"),
        "TM-27": ("TM-27", "reflectance", "fraction"),
    }
    for kind, expected in said.items():
        assert named(write, kind).kinds[0] == expected
    notes = " ".join(named(write, "absorbance").notes)
    assert "absorbance was made reflectance or transmittance: 10^-A" in notes
    assert "'gloss60' (gloss)" in " ".join(named(write, "a fraction beside gloss").notes)


PANES = {
    "IGDB": ("a.dat", kind_files.igdb()),
    "IGSDB 2": ("a.json", kind_files.igsdb_2()),
    "IGSDB 2, scattering": ("a.json", kind_files.igsdb_2(diffuse=True)),
}


@pytest.mark.parametrize(("name", "content"), PANES.values(), ids=PANES.keys())
def test_panes(write, name, content):
    path = write(name, content)
    read = read_reflectances(path)
    assert read.names == (
        "Clear transmittance",
        "Clear front reflectance",
        "Clear back reflectance",
    )
    np.testing.assert_allclose(read.values, [[0.8] * 81, [0.075] * 81, [0.08] * 81], atol=1e-9)
    told = ["transmittance", "reflectance", "reflectance"]
    assert [kind.quantity for kind in read.kinds] == told
    assert read_one(str(path), quantity="transmittance").names == ("Clear transmittance",)


def test_a_comment_tells_the_unit_of_what_is_dark(write):
    dark = text("# Diffuse reflectance of black felt, in percent", "nm,felt", rows(RED))
    np.testing.assert_allclose(
        read_reflectances(write("a.csv", dark)).values[0, 4], 5e-4, atol=1e-5
    )
    for line in (
        "# Luftfeuchte 45 Prozent",
        "# white standard 99 %",
        "# lamp warmed up, in percent",
    ):
        assert_red(read_reflectances(write("a.csv", text(line, "nm,red", rows(RED)))).values[0])


def test_each_column_is_decided_for_itself(write):
    path = write("a.csv", text("nm,dull,bright,thickness", rows(RED, PERCENT, 7000 * GREY)))
    assert_red(read_reflectances(path, column="dull").values[0])
    assert_red(read_reflectances(path, column="bright").values[0])
    with pytest.raises(InputError, match="'thickness': 2100 % is over"):
        read_reflectances(path, column="thickness")


def test_a_heading_speaks_for_its_own_column(write):
    """What another column is, or in what unit, says nothing of this one."""
    lines = rows(-np.log10(RED), PERCENT, RED)
    path = write("a.csv", text("nm,one (Abs),two (%T),three", lines))
    read = read_reflectances(path)
    assert [kind.quantity for kind in read.kinds] == ["absorbance", "transmittance", ""]
    for values in read.values:
        assert_red(values)


def test_percents_in_names_are_no_units(write):
    path = write("a.csv", text('nm,"Cotton 50 %","Grey 20%"', rows(RED, GREY)))
    assert_red(read_reflectances(path).values[0])


def test_noise_under_0_is_clipped_and_told(write):
    noisy = np.where(NM < 450, -0.0006, RED)
    read = read_reflectances(write("a.csv", text("nm,black", rows(noisy))))
    assert read.values.min() == 0.0
    assert any("under 0, at least -0.0006, were read as 0" in note for note in read.notes)
    lost = np.where(NM < 450, -0.02, RED)
    with pytest.raises(InputError, match="-0.02 is below 0"):
        read_reflectances(write("a.csv", text("nm,black", rows(lost))))


def test_a_start_at_420_nm_is_held_and_told(write):
    late = NM >= 420
    read = read_reflectances(write("a.csv", text("nm,red", rows(RED[late], x=NM[late]))))
    assert_red(read.values[0])
    assert read.measured == (420.0, 780.0) and "measured from 420" in read.notes[-1]
    later = NM >= 425
    with pytest.raises(InputError, match="covers 425-780 nm"):
        read_reflectances(write("a.csv", text("nm,red", rows(RED[later], x=NM[later]))))


def test_text_between_numbers_costs_its_column_alone(write):
    lines = rows(RED, RED)
    lines[30] = lines[30].rpartition(",")[0] + ",spilt"
    path = write("a.csv", text("nm,good,bad", lines))
    assert_red(read_reflectances(path, column="good").values[0])
    with pytest.raises(InputError, match=":32, column 'bad': 'spilt' is not a number"):
        read_reflectances(path)
    assert read_all(path).names == ("good",)


REFUSED = {
    "counts": (text("Wavelength,Counts", rows(3e4 * RED)), "holds counts, not reflectance"),
    "raw intensity": (text("Wavelength\tIntensity", rows(RED, sep="\t")), "holds counts"),
    "radiance": (text("nm,Radiance [W m-2 sr-1 nm-1]", rows(RED)), "holds light"),
    "irradiance in German": (text("nm;Bestrahlungsstärke (W/m²/nm)", rows(RED, sep=";")), "light"),
    "an instrument's unit": (text("YUNITS\tmW/m2", "XYDATA", rows(RED, sep="\t")), "holds light"),
    "absorptance": (text("nm,Absorptance", rows(RED)), "holds absorptance"),
    "absorption of some kind": (text("nm,Absorption (%)", rows(PERCENT)), "holds absorption"),
    "emissivity": (text("nm,Emissivity", rows(RED)), "holds emissivity"),
    "a lamp in TM-27": (kind_files.tm27("flux"), "holds light"),
    "irradiance over its unit": (
        text("Wave;Irradiance", "[nm];[µWatt/cm²/nm]", rows(RED, sep=";")),
        "holds light",
    ),
    "an A that may be a name": (text("nm,A", rows(0.5 * RED)), "absorbance, or a name"),
    "a display": (kind_files.cgats(more='DEVICE_CLASS "DISPLAY"'), "holds light"),
    "an emission in CGATS": (kind_files.cgats(more='MEAS_TYPE "EMISSION"'), "holds light"),
    "units that nobody knows": (kind_files.jcamp("ARBITRARY UNITS", RED), "holds arbitrary units"),
    "seconds": (kind_files.jcamp("REFLECTANCE", RED, x="SECONDS"), "wavelengths in 'SECONDS'"),
    "count of values": (
        kind_files.jcamp("REFLECTANCE", RED, form="SQZ").replace(b"NPOINTS= 81", b"NPOINTS= 80"),
        "81 values where NPOINTS is 80",
    ),
    "row numbers": (
        text(",red", [f"{k},{v:.4f}" for k, v in enumerate(RED)]),
        "counts rows",
    ),
    "row numbers for wavelengths": (
        text("wavelength,red", [f"{k},{0.4 + k / 1e4:.4f}" for k in range(1, 900)]),
        "count 1, 2, 3",
    ),
    "wavelengths both ways": (
        text(kind_files.in_rows(("nm", "{:g}"), *map(str, range(400, 701, 5)))),
        "in the heading .* and down the first column",
    ),
    "two tables": (
        text("nm,red", rows(RED), "second sample", rows(GREY)),
        "'second sample' stands among the rows of numbers",
    ),
    "decimal commas between commas": (
        text(kind_files.comma(rows(RED))),
        "semicolons",
    ),
    "frequencies": (text("Frequency (THz),red", rows(RED)), "'Frequency"),
    "fractions as Datacolor": (kind_files.qtx(scale=1.0), "percent or fraction"),
    "a broken difference": (
        kind_files.jcamp("REFLECTANCE", RED, form="DIF").replace(b"430E", b"430F", 1),
        "the last line ends with",
    ),
}
ENDING = {b"##": ".jdx", b"<?": ".spdx", b"[S": ".qtx", b"CG": ".ti3"}


@pytest.mark.parametrize(("content", "said"), REFUSED.values(), ids=REFUSED.keys())
def test_what_is_no_reflectance_is_refused_in_one_line(write, content, said):
    path = write("a" + ENDING.get(content[:2], ".csv"), content)
    with pytest.raises(InputError, match=said) as caught:
        read_reflectances(path)
    assert "\n" not in str(caught.value) and str(path) in str(caught.value)


def test_a_file_of_light_alone_is_about_something_else(write):
    with pytest.raises(NoSpectra):
        read_reflectances(write("a.spdx", kind_files.tm27("flux")))


def test_a_block_without_numbers_is_said(write):
    """Found by the fuzzer: each row has numbers, but none in the columns that count."""
    lines = [f",,{k},{k + 1}" for k in range(30)]
    with pytest.raises(InputError):
        read_reflectances(write("a.csv", text("nm,red", lines)))


JAPANESE = "試料名,赤\r\n測定日,2024年5月1日\r\n波長(nm),反射率(%)\r\n"
CHINESE = "样品名称,红\r\n波长(nm),反射率(%)\r\n"
KOREAN = "시료,빨강\r\n파장(nm),반사율(%)\r\n"
RUSSIAN = "Образец;Красный\r\nДлина волны, нм;Коэффициент отражения, %\r\n"
GERMAN = "Probe;Grün\r\nWellenlänge [nm];Reflexionsgrad [%]\r\n"


@pytest.mark.parametrize(
    ("encoding", "head"),
    [
        ("cp932", JAPANESE),
        ("gb18030", CHINESE),
        ("big5", JAPANESE.replace("試料名", "樣品").replace("測定日", "測量")),
        ("cp949", KOREAN),
        ("cp1251", RUSSIAN),
        ("koi8-r", RUSSIAN),
        ("latin-1", GERMAN),
        ("utf-8", JAPANESE),
        ("utf-16", CHINESE),
    ],
)
def test_headings_in_encodings_of_their_countries(write, encoding, head):
    """Their quantity and unit are read: dark percents would pass for fractions."""
    between = ";" if ";" in head else ","
    body = "\r\n".join(f"{nm}{between}{2.0 * red(nm):.4f}" for nm in range(380, 781, 10))
    read = read_reflectances(write("probe.csv", (head + body + "\r\n").encode(encoding)))
    assert_red(50.0 * read.values[0], atol=1.5e-3)
    assert read.kinds[0].quantity == "reflectance" and read.kinds[0].unit == "percent"


def test_an_encoding_needs_a_word_of_its_own():
    """Two bytes of German or French are characters of Japan too; they stay what they are."""
    for words in ("Wellenlänge", "Réflectance à 10°", "Größe", "Reflexión ñ", "ÄÖÜäöüßéèàç" * 9):
        assert national(words.encode("latin-1")) == "latin-1"
    cut = "波長,反射率".encode("cp932")
    assert national(cut[:-1]) == "cp932"  # within a character
