"""Whether another machine may be asked: never while Blender is offline, but for this one's own."""

from __future__ import annotations

import ipaddress
import sys
from urllib.parse import urlsplit

from ..errors import InputError


def check_online(address: str) -> None:
    """Raise InputError for an address beyond this machine while Blender may not go online.

    ``address``: a URL. Outside Blender, and as a module of Python, the user's asking is leave.
    """
    bpy = sys.modules.get("bpy")
    if bpy is None or bpy.app.online_access or _is_own(urlsplit(address).hostname or ""):
        return
    cure = "set Preferences > System > Allow Online Access"
    raise InputError(address, "is on the network, and Blender is offline", cure)


def _is_own(host: str) -> bool:
    """Whether a host is this machine's own address."""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"
