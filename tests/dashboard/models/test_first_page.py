import pytest

from railjoule.dashboard.models.first_page import first_page


@pytest.mark.parametrize(
    ("query", "page"),
    [
        ({}, "Start"),
        ({"v": [b"1"], "page": [b"Drive"]}, "Drive"),
        ({"page": [b"Trade-off"]}, "Trade-off"),
        ({"page": [b"Drive", b"Line"]}, "Line"),
        ({"page": [b"drive"]}, "Start"),
        ({"page": [b"<script>"]}, "Start"),
        ({"page": [b"\xff\xfe"]}, "Start"),
        ({"page": []}, "Start"),
    ],
)
def test_an_address_names_a_page_or_gets_start(query: dict[str, list[bytes]], page: str) -> None:
    assert first_page(query) == page
