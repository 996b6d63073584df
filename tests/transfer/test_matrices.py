"""The four identities of the method, an independent integration, and measured daylight."""

from dataclasses import replace

import colour
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.spectra import bases, sensitivities
from spectral_skylight.addon.spectra.grid import WAVELENGTHS, resample
from spectral_skylight.addon.spectra.reflectance import read_reflectances
from spectral_skylight.addon.spectra.table import read_table
from spectral_skylight.addon.spectra.working_spaces import (
    WORKING_SPACES,
    XYZ_to_working,
    primaries_to_rec709,
    rec709_to_working,
)
from spectral_skylight.addon.transfer.known_light import KnownLight
from spectral_skylight.addon.transfer.matrices import transfer
from spectral_skylight.addon.transfer.measures import delta_E
from spectral_skylight.addon.transfer.prediction import predict, rgb_albedo

IDENTITY = 1e-12
"""Rounding of a few hundred float64 operations on numbers of size 1."""

THEIRS = {
    "Linear Rec.709": "ITU-R BT.709",
    "Linear Rec.2020": "ITU-R BT.2020",
    "ACEScg": "ACEScg",
}
"""colour-science's name of each working space."""

reflectance = arrays(float, 81, elements=st.floats(0.0, 1.0))


@pytest.fixture(scope="module")
def checker():
    """The 24 surfaces of the BabelColor average, 380 to 730 nm by 10 nm."""
    sds = colour.SDS_COLOURCHECKERS["BabelColor Average"].values()
    return np.stack([resample(sd.wavelengths, sd.values) for sd in sds])


@given(st.floats(0.0, 1.0))
@pytest.mark.parametrize("basis", bases.BASES)
def test_grey_is_a_multiple_of_white(basis, c):
    M = transfer(basis).matrices(np.full(81, c))
    np.testing.assert_allclose(M, c * np.eye(3), atol=IDENTITY)


@given(st.floats(0.0, 1.0))
def test_grey_is_a_multiple_of_white_for_a_camera(c):
    raw = transfer(camera="Nikon 5100")
    np.testing.assert_allclose(
        raw.matrices(np.full(81, c)),
        c * raw.to_working,
        atol=IDENTITY * np.abs(raw.to_working).max(),
    )


@given(reflectance, reflectance, st.floats(-2, 2))
def test_linear_in_the_reflectance(a, b, c):
    t = transfer()
    np.testing.assert_allclose(
        t.matrices(a + c * b), t.matrices(a) + c * t.matrices(b), atol=20 * IDENTITY
    )


@settings(max_examples=50)
@given(arrays(float, (3, 3), elements=st.floats(-1, 1)), st.floats(1e-3, 1e3))
@example(1e-183 * (1.0 - np.eye(3)), 1.0)
def test_depends_on_the_span_of_the_basis_alone(mix, scale):
    # The rounding grows with the condition of the mix: leave out those that lose more than a digit.
    if np.linalg.cond(mix) > 10:
        return
    t = transfer()
    mixed = replace(t, restoration=bases.restoration(scale * mix @ bases.rayleigh(), t.S_in))
    rho = np.linspace(0.0, 1.0, 81)
    np.testing.assert_allclose(mixed.matrices(rho), t.matrices(rho), atol=50 * IDENTITY)


@pytest.mark.parametrize("space", WORKING_SPACES)
def test_changes_with_the_working_space_by_similarity(space, checker):
    T = rec709_to_working(space)
    np.testing.assert_allclose(
        transfer(space=space).matrices(checker),
        T @ transfer().matrices(checker) @ np.linalg.inv(T),
        atol=IDENTITY,
    )


@pytest.mark.parametrize("space", WORKING_SPACES)
def test_white_is_one_in_every_space(space):
    np.testing.assert_allclose(rec709_to_working(space) @ np.ones(3), 1.0, atol=1e-9)
    # colour-science's own conversion, from primaries published to four digits
    theirs = colour.matrix_RGB_to_RGB(
        colour.RGB_COLOURSPACES["ITU-R BT.709"],
        colour.RGB_COLOURSPACES[THEIRS[space]],
        "Bradford",
    )
    np.testing.assert_allclose(rec709_to_working(space), theirs, atol=2e-4)


@pytest.mark.parametrize("space", WORKING_SPACES)
def test_spaces_have_their_published_primaries_and_whites(space):
    published = colour.RGB_COLOURSPACES[THEIRS[space]]
    expected = [*published.primaries.ravel(), *published.whitepoint]
    np.testing.assert_array_equal(WORKING_SPACES[space], expected)


@pytest.mark.parametrize("space", WORKING_SPACES)
def test_spaces_are_colour_science_s_from_the_primaries(space):
    rec709 = colour.RGB_COLOURSPACES["ITU-R BT.709"]
    target = colour.RGB_COLOURSPACES[THEIRS[space]]
    adapt = colour.adaptation.matrix_chromatic_adaptation_VonKries(
        colour.xy_to_XYZ(rec709.whitepoint), colour.xy_to_XYZ(target.whitepoint), "Bradford"
    )
    to_XYZ = colour.normalised_primary_matrix(target.primaries, target.whitepoint)
    theirs = np.linalg.inv(to_XYZ) @ adapt
    np.testing.assert_allclose(XYZ_to_working(space), theirs, atol=IDENTITY)
    xy = [*target.primaries.ravel(), *target.whitepoint]
    back = np.linalg.inv(rec709_to_working(space))
    np.testing.assert_allclose(primaries_to_rec709(xy), back, atol=IDENTITY)


def test_agrees_with_a_direct_integration_at_1_nm(checker):
    """Three sky spectra of the basis fix each matrix; integrate them by colour-science alone."""
    shape = colour.SpectralShape(380, 780, 1)
    from colour.plotting.datasets.astm_g_173 import SD_ASTMG173_ETR

    sun = SD_ASTMG173_ETR.copy().interpolate(shape).values
    cmfs = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(shape).values
    to_RGB = colour.RGB_COLOURSPACES["ITU-R BT.709"].matrix_XYZ_to_RGB
    B = [sun * (550.0 / shape.wavelengths) ** (4 * i) for i in range(3)]
    A = np.stack([to_RGB @ (cmfs.T @ b) for b in B], axis=1)
    M = transfer().matrices(checker)
    for k, sd in enumerate(colour.SDS_COLOURCHECKERS["BabelColor Average"].values()):
        rho = (
            sd.copy()
            .align(shape, extrapolator_kwargs={"method": "Constant", "left": None, "right": None})
            .values
        )
        direct = np.stack([to_RGB @ (cmfs.T @ (rho * b)) for b in B], axis=1) @ np.linalg.inv(A)
        # The bound: colour-science's Sprague and our monotone cubics differ between
        # samples 10 nm apart, and 5 nm hats are not 1 nm sums.
        assert np.abs(M[k] - direct).max() < 0.01 * np.abs(direct).max()


def test_all_at_once_is_one_by_one(checker):
    t = transfer()
    np.testing.assert_allclose(
        t.matrices(checker), [t.matrices(rho) for rho in checker], atol=IDENTITY
    )


@given(arrays(float, 3, elements=st.floats(0.05, 20)), reflectance)
def test_a_balanced_sky_is_undone(white, rho):
    D = np.diag(1 / white)
    plain, balanced = transfer().matrices(rho), transfer(white=white).matrices(rho)
    np.testing.assert_allclose(balanced, D @ plain @ np.linalg.inv(D), atol=400 * IDENTITY)
    rgb = np.array([0.2, 0.5, 0.9])
    np.testing.assert_allclose(white * (balanced @ (D @ rgb)), plain @ rgb, atol=400 * IDENTITY)


@given(arrays(float, 3, elements=st.floats(0.05, 20)))
def test_a_balanced_camera_sky_keeps_neutral_neutral(white):
    M = transfer(camera="Nikon 5100", white=white).to_working
    np.testing.assert_allclose(M @ np.ones(3), 1.0, atol=1e-9)


def stanford(shared_data):
    table = read_table(shared_data / "sky/stanford_dicarlo/daylightSpectra.csv")
    return resample(table.wavelengths, table.values)


@pytest.mark.parametrize(
    ("camera", "largest"),
    [
        ("rawtoaces/Canon_EOS_5D_Mark_II_380_780_5.csv", 0.3),
        ("rawtoaces/Canon_EOS_R5_380_780_5.csv", 0.3),
        ("rawtoaces/Sony_ILCE-7M3_380_780_5.csv", 0.3),
        # Curves further from the observer's: what haze and ozone, which the basis does not
        # hold, cost there. The figures are what was measured, rounded up.
        ("colour_science/Nikon_5100_NPL_.csv", 0.31),
        ("rawtoaces/ARRI_D21_380_780_5.csv", 0.32),
        ("rawtoaces/Arashi_Vision_Insta360_X5_380_780_5.csv", 0.63),
    ],
)
def test_a_raw_camera_sky_comes_to_the_working_space(shared_data, camera, largest):
    """Known skies through measured curves: exact inside the model, near 0.3 on ASTM G173."""
    raw = transfer(camera=str(shared_data / "camera" / camera))
    skies = np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1], [0.2, 1, 0.4]]) @ bases.rayleigh()
    np.testing.assert_allclose(
        skies @ raw.S_in.T @ raw.to_working.T, skies @ raw.S_out.T, rtol=1e-9
    )
    table = read_table(shared_data / "sky/astm_g173/astm_g173.csv")
    _, total, direct = resample(table.wavelengths, table.values)
    skies = np.stack([total, direct])
    true = skies @ raw.S_out.T
    assert delta_E(skies @ raw.S_in.T @ raw.to_working.T, true, true).max() < largest


def test_measured_daylight(shared_data, checker):
    """The issue's figures: mean CIEDE2000 at most 0.17 where RGB times RGB leaves 0.54."""
    t = transfer()
    skies = stanford(shared_data)
    white = (skies @ t.S_out.T)[:, None]
    true = np.einsum("il,ml,kl->kmi", t.S_out, checker, skies)
    ours = np.einsum("mij,kj->kmi", t.matrices(checker), white[:, 0])
    assert delta_E(ours, true, white).mean() <= 0.17
    assert delta_E(rgb_albedo(checker) * white, true, white).mean() == pytest.approx(
        0.54, abs=0.005
    )


def test_cyan_is_reported_out_of_gamut(checker):
    t = transfer()
    cyan = predict(t, checker[[17]], KnownLight(np.ones(3)))
    assert cyan.colour[0, 0] < 0 and cyan.out_of_gamut[0]
    grey = predict(t, np.full((1, 81), 0.3), KnownLight(np.ones(3)))
    assert not grey.out_of_gamut[0]


def test_dark_sky_predicts_nothing():
    assert np.isnan(predict(transfer(), np.full((1, 81), 0.3), KnownLight(np.zeros(3))).rgb).all()


@pytest.mark.parametrize(
    "options",
    [
        {"basis": "fourier"},
        {"space": "sRGB"},
        {"camera": "Brownie"},
        {"white": (1.0, 0.0, 1.0)},
        {"white": (1.0, 1.0)},
        {"white": (1.0, np.nan, 1.0)},
    ],
)
def test_wrong_options_name_the_choices(options):
    with pytest.raises(InputError) as caught:
        transfer(**options)
    assert str(caught.value).startswith(f"{next(iter(options))}: ") and "\n" not in str(
        caught.value
    )


def test_camera_curves_are_zero_where_not_measured():
    S = sensitivities.camera("Sigma SDMerill")  # 400 to 680 nm
    assert not S[:, (WAVELENGTHS < 400) | (WAVELENGTHS > 680)].any() and S[:, 10:40].any()


def test_camera_file_and_name_agree(shared_data):
    by_file = sensitivities.camera(str(shared_data / "camera/colour_science/Nikon_5100_NPL_.csv"))
    np.testing.assert_allclose(by_file, sensitivities.camera("nikon5100"), rtol=1e-5, atol=1e-12)


def test_camera_file_without_three_columns_is_refused(tmp_path):
    path = tmp_path / "camera.csv"
    path.write_text("nm,R,G\n400,1,1\n700,1,1\n", encoding="utf-8")
    with pytest.raises(InputError, match="give wavelength, R, G and B"):
        sensitivities.camera(str(path))


def test_reader_and_library_give_the_same_matrices(shared_data, checker):
    path = shared_data / "reflectance/colour_science_checkers/BabelColor_Average.csv"
    np.testing.assert_allclose(
        transfer().matrices(read_reflectances(path).values),
        transfer().matrices(checker),
        atol=1e-5,  # the file holds five digits
    )
