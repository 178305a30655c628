"""Address and names under which the dashboard is served; without the libraries of the page, for the command line."""

import contextlib
import ipaddress
import re
import socket
from dataclasses import dataclass

DEFAULT_ADDRESS, DEFAULT_PORT = "127.0.0.1", 5006
NO_LOGIN = "There is no login: everybody who reaches the port can use the pages, and save in the folder of --folder."
EXPOSED = (
    "Anyone who reaches the port sees every page, can let this machine compute within the limits of a page, and can "
    "read the state of the server at /health and /ready. No file of this machine can be read there but those of "
    "the folder of --folder."
)
LOCAL_NAMES = ("localhost", "127.0.0.1")
"""A browser on this machine may call the server by any of them."""
ORIGIN = re.compile(r"(?P<name>[A-Za-z0-9](?:[A-Za-z0-9.-]*[A-Za-z0-9])?)(?::(?P<port>\d{1,5}))?")
"""A host's name or address with or without a port."""
PREFIX = re.compile(r"(?:/[A-Za-z0-9._~-]+)+")
HIGHEST_PORT = 65_535


@dataclass(frozen=True)
class ServerOptions:
    """Address of the dashboard and its permitted visitors.

    Parameters
    ----------
    address : str
        Address to listen at.
    port : int
        The port to listen on.
    origins : tuple of str
        Further names, with or without a port, under which browsers reach it, as behind a proxy.
    prefix : str
        The path below which it is served, such as "/tools/railjoule"; empty for the root.
    sessions : int or None
        How many pages may be open at a time; None for any number.
    """

    address: str = DEFAULT_ADDRESS
    port: int = DEFAULT_PORT
    origins: tuple[str, ...] = ()
    prefix: str = ""
    sessions: int | None = None

    @property
    def is_for_this_machine(self) -> bool:
        """Whether only programs of this machine reach it."""
        return is_this_machine(self.address)

    @property
    def names(self) -> frozenset[str]:
        """The names by which a browser may call it, in small letters."""
        listened = this_machine() if self._listens_everywhere else (self.address,)
        own = (origin_parts(origin)[0] for origin in self.origins)
        # Bokeh lets no page open a connection that was called by an address of IPv6: it would stay without numbers
        return frozenset(name.lower() for name in (*LOCAL_NAMES, *listened, *own) if ":" not in name)

    @property
    def websocket_origins(self) -> list[str]:
        """The names with ports of pages that may open a connection."""
        here = sorted(self.names - {origin_parts(origin)[0].lower() for origin in self.origins})
        return [*(f"{name}:{self.port}" for name in here), *self.origins]

    @property
    def _listens_everywhere(self) -> bool:
        try:
            return not self.address or ipaddress.ip_address(self.address).is_unspecified
        except ValueError:
            return False


def is_this_machine(address: str) -> bool:
    """Return whether only programs of this machine reach an address."""
    try:
        return address == "localhost" or ipaddress.ip_address(address).is_loopback
    except ValueError:
        return False


def this_machine() -> tuple[str, ...]:
    """Return this machine's names and addresses, as far as they can be found."""
    names = {socket.gethostname(), socket.getfqdn()}
    # a machine may not know its own name; --origin names it then
    with contextlib.suppress(OSError):
        names |= {str(found[4][0]).partition("%")[0] for found in socket.getaddrinfo(socket.gethostname(), None)}
    return tuple(sorted(names - {""}))


def origin_parts(origin: str) -> tuple[str, int | None]:
    """Return the name and the port of an origin, such as railways.example:8080; the port is None where it has none.

    Raises
    ------
    ValueError
        If it is none.
    """
    found = ORIGIN.fullmatch(origin)
    port = int(found["port"]) if found and found["port"] else None
    if found is None or (port is not None and not 1 <= port <= HIGHEST_PORT):
        raise ValueError("must be NAME or NAME:PORT, such as railways.example:8080")
    return found["name"], port
