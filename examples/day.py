"""One clear day on the faces of a building, as the paper tells it:  sh examples/run day

Tokyo at the equinox, twice: under the paper's own sky (air that scatters once or twice, and nothing
else), and under one with ozone, haze, water, ground and all orders of scattering. Every half hour,
24 patches, nine faces. Figures and tables: examples/out/day/
"""

from pathlib import Path

from spectral_skylight.addon.evaluation.report import report_day
from spectral_skylight.addon.spectra.colorchecker import colorchecker

OUT = Path(__file__).resolve().parent / "out" / "day"
PLACE = ("2025-03-20", 35.68, 139.77, "+9")


def main() -> None:
    """Run the evaluation and tell what it found."""
    result = report_day(
        OUT, PLACE, colorchecker(), ["rayleigh", "daylight", "atmosphere"], progress=True
    )
    for air, sky in result["skies"].items():
        print(f"\nUnder {air}, CIEDE2000 over the day (mean, 95th percentile, largest):")
        for method in sky["methods"]:
            numbers = " ".join(f"{method['delta_E'][key]:6.3f}" for key in ("mean", "p95", "max"))
            print(f"  {method['method']:30} {numbers}")
        print("The paper's claims about relative error, with its own basis:")
        for line in told(sky["claims"]):
            print(f"  {line}")
    print(f"\nFigures and tables: {OUT}")


def told(claims: dict) -> list[str]:
    """Put the figures of `report.claims` beside what the paper says."""
    gain = claims["times_smaller_than_rgb"]
    return [
        "patch 1, face up, 12 to 16 h, is under 0.01: "
        f"{claims['first_material_up_12_to_16_max']:.4f}",
        f"smaller by high sun: {claims['mean_high_sun']:.4f} over 30°, "
        f"{claims['mean_low_sun']:.4f} below",
        f"smaller on level faces: {claims['mean_face_up']:.4f} up, "
        f"{claims['mean_faces_vertical']:.4f} vertical",
        f"coloured patches, 10 to 100 times smaller than RGB × RGB: {gain['least']:.1f} to "
        f"{gain['most']:.1f} times, median {gain['median']:.1f}",
    ]


if __name__ == "__main__":
    main()
