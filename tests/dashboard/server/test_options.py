import socket

import pytest

from railjoule.dashboard.server.options import ServerOptions, origin_parts


@pytest.mark.parametrize(
    ("origin", "parts"),
    [
        ("railways.example", ("railways.example", None)),
        ("railways.example:8080", ("railways.example", 8080)),
        ("10.0.0.7:65535", ("10.0.0.7", 65_535)),
    ],
)
def test_an_origin_is_a_name_with_or_without_a_port(origin: str, parts: tuple[str, int | None]) -> None:
    assert origin_parts(origin) == parts


@pytest.mark.parametrize(
    "origin", ["", "*", "https://a.example", "a.example:0", "a.example:65536", "a b", "a/x", "[::1]:80"]
)
def test_what_is_none_is_refused_with_an_example(origin: str) -> None:
    with pytest.raises(ValueError, match=r"such as railways.example:8080"):
        origin_parts(origin)


def test_by_default_this_machine_alone_is_served_by_its_local_names() -> None:
    options = ServerOptions(port=5100)
    assert options.is_for_this_machine
    assert options.names == {"localhost", "127.0.0.1"}
    assert options.websocket_origins == ["127.0.0.1:5100", "localhost:5100"]


def test_an_address_for_all_is_known_by_the_machines_own_names() -> None:
    options = ServerOptions(address="0.0.0.0", port=80)
    assert not options.is_for_this_machine
    assert socket.gethostname().lower() in options.names
    assert "0.0.0.0" not in options.names


def test_named_origins_keep_their_own_ports() -> None:
    options = ServerOptions(origins=("railways.example", "other.example:8080"))
    assert {"railways.example", "other.example"} < options.names
    assert options.websocket_origins[-2:] == ["railways.example", "other.example:8080"]
