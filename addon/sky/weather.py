"""The sky of the weather that is asked for: clear, a standard one, or that of a measured hour."""

from __future__ import annotations

from ..choices import STANDARD_SKIES
from ..errors import InputError, parameter
from .all_weather import SOLAR_CONSTANT, all_weather_sky
from .cie_skies import cie_sky
from .clear_sky import Sky
from .epw import WeatherHour
from .simulation import SimulatedSky


def under_weather(
    clear: SimulatedSky,
    *,
    cie: int | None = None,
    illuminance: float | None = None,
    hour: WeatherHour | None = None,
) -> tuple[Sky, str]:
    """Return a simulated clear sky as the weather changes it, and what that is called.

    ``cie``: the number of a standard sky, and its ``illuminance`` [lx]; ``hour``: of a weather
    file; without either the sky itself. Raises InputError as `cie_sky` and `all_weather_sky` do,
    and for an illuminance without a standard sky.
    """
    if hour is not None:
        outside = hour.extraterrestrial or SOLAR_CONSTANT
        sky = all_weather_sky(clear, hour.direct, hour.diffuse, extraterrestrial=outside)
        measured = f"direct {hour.direct:g} and diffuse {hour.diffuse:g} W/m²"
        return sky, f"sky of {hour.station.name}: {measured}, {100 * sky.cover:.0f} % cloud"
    if cie is not None:
        found = cie_sky(cie, clear, illuminance)
        return found, f"CIE standard sky {cie}, {STANDARD_SKIES[str(cie)].description}"
    if illuminance is not None:
        cure = f"give {parameter('cie')} too"
        raise InputError(parameter("illuminance"), "is of a standard sky", cure)
    return clear, "clear sky"
