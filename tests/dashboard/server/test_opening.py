import asyncio
from unittest.mock import Mock

import pytest
from tornado.httputil import HTTPHeaders, HTTPServerRequest, RequestStartLine
from tornado.web import Application, HTTPError

from railjoule.dashboard.server import opening
from railjoule.dashboard.server.opening import TOKEN, Opening, PageSocket


def test_each_browser_gets_the_same_but_for_its_token() -> None:
    one = Opening(f"<p>{TOKEN}</p>")
    assert (one.html("first"), one.html("second")) == ("<p>first</p>", "<p>second</p>")


def test_pages_are_awaited_until_they_open_or_are_left(monkeypatch: pytest.MonkeyPatch) -> None:
    async def opened(one: Opening) -> None:
        async with one.turn():
            pass

    one = Opening(TOKEN)
    one.html("first")
    one.html("second")
    assert one.taken_places == 2
    asyncio.run(opened(one))
    assert one.taken_places == 1
    # a server behind a proxy, where a page opens that another server has answered
    other = Opening(TOKEN)
    asyncio.run(opened(other))
    assert other.taken_places == 0
    monkeypatch.setattr(opening, "OPENS_WITHIN_S", -1.0)
    assert one.taken_places == 0


def test_a_connection_finds_the_place_that_was_kept_for_its_page() -> None:
    open_pages = [2]
    one = Opening(TOKEN, most=3, count_open=lambda: open_pages[0])
    one.html("first")
    assert one.taken_places == 3
    open_pages[0] = 3
    assert one.has_place


def test_a_connection_without_a_place_is_refused() -> None:
    open_pages = [2]
    one = Opening(TOKEN, most=2, count_open=lambda: open_pages[0])
    assert not one.has_place
    open_pages[0] = 1
    assert one.has_place


def test_without_a_limit_there_is_always_a_place() -> None:
    assert Opening(TOKEN, count_open=lambda: 1000).has_place


def test_one_page_is_made_at_a_time_and_others_have_their_turns_between() -> None:
    order: list[str] = []

    async def make(one: Opening, name: str) -> None:
        async with one.turn():
            order.append(name)
            await asyncio.sleep(0)
            order.append(name)

    async def beside() -> None:
        for _ in range(100):
            order.append(".")
            await asyncio.sleep(opening.BREATH_S / 10)

    async def all_at_once() -> None:
        one, moves = Opening(TOKEN), asyncio.create_task(beside())
        await asyncio.gather(*(make(one, name) for name in "abc"))
        moves.cancel()

    asyncio.run(all_at_once())
    made = "".join(order)
    assert made.replace(".", "") == "aabbcc"
    # a turn of the others may fall between the two halves of one as well
    assert all("." in part for part in (made[: made.index("a")], made[made.rindex("a") : made.index("b")]))


@pytest.mark.parametrize("patience_s", [0.05, 10.0])
def test_a_page_that_opens_lets_those_go_first_that_wait_but_not_for_ever(
    patience_s: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(opening, "MOVE_S", patience_s)
    asked: list[float] = []

    def wait_thrice(longest_s: float) -> bool:
        asked.append(longest_s)
        return patience_s < 1 or len(asked) <= 3

    async def opened() -> None:
        async with Opening(TOKEN, others_wait=wait_thrice).turn():
            asked.append(0.0)

    asyncio.run(opened())
    assert asked[-1] == 0.0
    assert set(asked[:-1]) == {patience_s}
    # 5 ms between two looks
    assert len(asked) == 5 if patience_s > 1 else 2 < len(asked) <= 12


# no base64, half of it, no JSON, JSON without a session, with one and without an end
@pytest.mark.parametrize("token", ["nonsense", "a.b", "e30", "W10.e30", "eyJzZXNzaW9uX2lkIjoiYSJ9"])
def test_a_connection_whose_token_is_none_is_refused_in_a_line(token: str) -> None:
    application = Application()
    line, headers = RequestStartLine("GET", "/ws", "HTTP/1.1"), HTTPHeaders({"Host": "localhost"})
    request = HTTPServerRequest(start_line=line, headers=headers, connection=Mock())
    application.sign_sessions, application.secret_key = False, None
    known = {"application_context": Mock(), "bokeh_websocket_path": "/ws"}
    socket = PageSocket(application, request, opening=Opening(TOKEN), **known)
    socket.select_subprotocol(["bokeh", token])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(PageSocket, "selected_subprotocol", "bokeh")
        patch.setattr(PageSocket, "close", lambda _: None)
        with pytest.raises(HTTPError) as refused:
            socket.open()
    assert refused.value.status_code == 403
    assert token not in str(refused.value)
