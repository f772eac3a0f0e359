"""The address of a robot's driver, which is on this machine: the protocol has no passwords and no
encryption."""

from __future__ import annotations

import ipaddress
from dataclasses import dataclass

PORT = 7420
"""Where a driver listens, unless it says otherwise. Chosen."""


@dataclass(frozen=True, slots=True)
class Address:
    """A port of this machine."""

    host: str
    port: int

    def __str__(self) -> str:
        return f"[{self.host}]:{self.port}" if ":" in self.host else f"{self.host}:{self.port}"


def address_of(text: str) -> Address:
    """Reads `127.0.0.1:7420`, `[::1]:7420` or `localhost:7420`. Raises ValueError, with what to do, for an
    address of another machine, whose port ssh brings here."""
    host, colon, port = text.rpartition(":")
    host = host.removeprefix("[").removesuffix("]")
    if not colon or not host or not (port.isascii() and port.isdecimal()) or not 0 < int(port[:6]) < 1 << 16:
        raise ValueError('an address is a host and a port, as "127.0.0.1:7420"')
    if not is_here(host):
        raise ValueError(
            f"`{host}` is another machine, and whoever reaches a driver can move its robot: bring its port "
            f"here by `ssh -N -L {int(port)}:127.0.0.1:{int(port)} {host}` and use 127.0.0.1:{int(port)}"
        )
    return Address("127.0.0.1" if host == "localhost" else host, int(port))


def is_here(host: str) -> bool:
    """Whether whoever reaches this host is on this machine."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False
