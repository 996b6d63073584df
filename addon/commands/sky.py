"""`sky`: a clear sky, a standard one of the CIE or one of measured weather, as a lat-long HDRI."""

from __future__ import annotations

import argparse
import sys
from typing import Any

from ..choices import QUALITIES, default, described
from ..errors import InputError
from .arguments import Commands, add_place, place_of
from .outputs import output


def add(commands: Commands) -> None:
    """Add the command to those of the parser."""
    parser = commands.add_parser("sky", help="simulate a sky as a lat-long HDRI")
    parser.add_argument("--sun-elevation", type=float, metavar="DEG", help="in degrees, -6 to 90")
    parser.add_argument(
        "--sun-azimuth", type=float, metavar="DEG", help="in degrees from north; default 180"
    )
    parser.add_argument(
        "--date", metavar="YYYY-MM-DD", help="compute the sun's position from date, time and place"
    )
    parser.add_argument(
        "--time", default="12:00", metavar="HH:MM", help="local time; default: noon"
    )
    add_place(parser)
    parser.add_argument(
        "--cie",
        type=int,
        metavar="N",
        help="CIE standard general sky of that number instead of a clear sky: 1 overcast, "
        "5 uniform, 12 clear, up to 15",
    )
    parser.add_argument(
        "--epw",
        metavar="FILE.epw",
        help="sky of an hour's measured weather: place and zone are the file's, --date and --time "
        "in its standard time",
    )
    parser.add_argument(
        "--illuminance",
        type=float,
        metavar="LUX",
        help="of --cie: illuminance of the sky, without the sun, on level ground; by default "
        "that of the clear sky and of a mean overcast one, by the sky's share of cloud",
    )
    parser.add_argument(
        "--sun-disc", action="store_true", help="include the sun's disc in the picture"
    )
    haze = parser.add_mutually_exclusive_group()
    haze.add_argument("--haze", type=float, help="aerosol optical depth at 550 nm; default 0.05")
    haze.add_argument(
        "--turbidity",
        type=float,
        metavar="B",
        help="Ångström's turbidity: aerosol optical depth at 1000 nm",
    )
    parser.add_argument(
        "--angstrom", type=float, default=1.3, help="Ångström's exponent of the aerosol"
    )
    parser.add_argument(
        "--ozone", type=float, default=300.0, metavar="DU", help="ozone column in Dobson units"
    )
    parser.add_argument("--water", type=float, default=14.0, metavar="MM", help="precipitable")
    parser.add_argument(
        "--ground",
        default="0.2",
        metavar="R|FILE.csv[:COLUMN]",
        help="reflectance of the ground, 0 to 1, or a CSV",
    )
    parser.add_argument(
        "--paper", action="store_true", help="air of Tachi's paper: λ⁻⁴ scattering, no absorption"
    )
    parser.add_argument("--orders", default="all", metavar="N|all", help="orders of scattering")
    parser.add_argument(
        "--quality",
        choices=tuple(QUALITIES),
        default=default(QUALITIES),
        help=described(QUALITIES),
    )
    parser.add_argument("--seed", type=int, default=0, help="seed of the random photons")
    parser.add_argument(
        "--width", type=int, default=1024, help="width in pixels; the height is half of it"
    )
    parser.add_argument(
        "--out",
        type=output(".exr"),
        metavar="SKY.exr",
        help="HDRI in linear Rec.709; 1 is 10,000 cd/m²",
    )
    parser.add_argument(
        "--spectral",
        type=output(".exr"),
        metavar="SPECTRAL.exr",
        help="spectral radiance in W m⁻² sr⁻¹ nm⁻¹, 81 channels",
    )
    parser.add_argument(
        "--heliodon",
        type=output(".png"),
        metavar="PATHS.png",
        help="draw the sun's paths over the place, with hours, and where the sun stands",
    )
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Simulate the sky, write it, and say where the sun stands."""
    if not (options.out or options.spectral or options.heliodon):
        cure = "give --out SKY.exr, --spectral FILE.exr or --heliodon FILE.png"
        raise InputError("sky", "no output file", cure)
    if not 8 <= options.width <= 8192:
        raise InputError("--width", f"{options.width} pixels", "give 8 to 8192")
    hour = _hour(options)
    _settle(options)
    elevation, azimuth = _sun(options)
    if options.heliodon and options.date is None:
        cure = "give --date with --city, or with --latitude and --longitude"
        raise InputError("--heliodon", "the place is unknown", cure)
    if options.out or options.spectral:
        _simulate(options, hour, elevation, azimuth)
    else:
        print(f"sun at {elevation:.2f}°, azimuth {azimuth:.2f}°")
    if options.heliodon:
        _draw_heliodon(options, hour)


def _simulate(options: argparse.Namespace, hour: Any, elevation: float, azimuth: float) -> None:
    """Simulate the sky and write it."""
    from ..sky.clear_sky import SCALE, header_of, picture
    from ..sky.panorama import write_panorama, write_spectral
    from ..sky.simulation import simulate
    from ..sky.weather import under_weather
    from ..spectra.grid import WAVELENGTHS
    from ..spectra.sensitivities import observer

    if not abs(azimuth) <= 360.0:
        raise InputError("--sun-azimuth", f"{azimuth:g}°", "give -360 to 360")
    orders = options.orders
    if orders != "all" and not orders.isdecimal():
        raise InputError("--orders", f"'{orders}'", "give 1, 2, … or all")
    sky = simulate(
        elevation,
        _atmosphere(options),
        orders=None if orders == "all" else int(orders),
        quality=options.quality,
        seed=options.seed,
        progress=sys.stderr.isatty(),
    )
    shown, kind = under_weather(sky, cie=options.cie, illuminance=options.illuminance, hour=hour)
    view = options.width // 2, azimuth, options.sun_disc
    if options.out:
        attributes = {
            **header_of(shown, azimuth, options.sun_disc),
            "comments": f"{kind}, sun elevation {elevation:.4g}, azimuth {azimuth:.4g} degrees",
        }
        write_panorama(options.out, picture(shown, *view, observer() * SCALE), attributes)
    if options.spectral:
        write_spectral(options.spectral, picture(shown, *view), WAVELENGTHS)
    error = (sky.irradiance_error() / sky.irradiance()).max()
    if shown is not sky:
        print(kind)
    print(
        f"sun at {elevation:.2f}°, azimuth {azimuth:.2f}°; "
        f"standard error of the irradiance at most {100 * error:.2f} % at any wavelength"
    )


def _draw_heliodon(options: argparse.Namespace, hour: Any) -> None:
    """Draw the sun's paths over the place that the options name."""
    from ..pictures.heliodon import Heliodon, heliodon
    from ..pictures.png_file import write_png
    from ..pictures.theme import LIGHT
    from ..sky.sun_position import local_moment

    moment = local_moment(options.date, options.time, options.timezone)
    shown = Heliodon(moment, options.latitude, options.longitude)
    title = hour.station.name if hour is not None else options.city
    write_png(options.heliodon, heliodon(shown, title, theme=LIGHT, scale=1.5))


def _hour(options: argparse.Namespace) -> Any:
    """Return the hour of a weather file, None without; the options get its place and zone."""
    if options.epw is None:
        return None
    from ..sky.epw import read_hour

    if options.cie is not None:
        raise InputError("--epw", "says what the sky is like", "leave --cie out")
    if options.date is None:
        raise InputError("--epw", "the hour is unknown", "give --date and --time too")
    for name in ("city", "latitude", "longitude", "timezone"):
        if getattr(options, name) is not None:
            raise InputError("--epw", "says place and time zone", f"leave --{name} out")
    hour = read_hour(options.epw, options.date, options.time)
    station = hour.station
    options.latitude, options.longitude = station.latitude, station.longitude
    options.timezone = station.timezone
    return hour


def _settle(options: argparse.Namespace) -> None:
    """Give the options the place and the zone that they name; nothing without a date."""
    if options.date is None:
        if options.city is not None:
            raise InputError("--city", "the day is unknown", "give --date too")
        return
    if options.sun_elevation is not None:
        return  # `_sun` refuses both
    found = place_of(options)
    options.city, options.timezone = found.name, found.timezone
    options.latitude, options.longitude = found.latitude, found.longitude


def _sun(options: argparse.Namespace) -> tuple[float, float]:
    """Return where the sun stands: given, or by date and place."""
    given = options.sun_elevation is not None
    if given == (options.date is not None):
        cure = "give either --sun-elevation or --date with --latitude and --longitude"
        raise InputError("sky", "the sun's position is unknown", cure)
    if given:
        return options.sun_elevation, 180.0 if options.sun_azimuth is None else options.sun_azimuth
    from ..sky.sun_position import sun_position

    elevation, azimuth = sun_position(
        options.date, options.time, options.latitude, options.longitude, options.timezone
    )
    return elevation, azimuth if options.sun_azimuth is None else options.sun_azimuth


def _atmosphere(options: argparse.Namespace) -> Any:
    """Return the air over the ground that the options describe."""
    from dataclasses import replace

    from ..sky.atmosphere import Atmosphere
    from ..sky.simulation import PAPER
    from ..spectra.reflectance import read_assigned

    try:
        ground = float(options.ground)
    except ValueError:
        _, ground = read_assigned(options.ground)
    if options.paper:
        return replace(PAPER, ground=ground)
    haze = 0.05 if options.haze is None else options.haze
    if options.turbidity is not None:
        haze = options.turbidity * 0.55**-options.angstrom
    return Atmosphere(
        haze=haze,
        angstrom=options.angstrom,
        ozone=options.ozone,
        water=options.water,
        ground=ground,
    )
