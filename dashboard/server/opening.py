"""How a page opens: its first answer is the same for all, and its state is made where its connection arrives.

The first answer names the scripts and contains nothing of the page but its token, which contains its address. So
it is written once for all, and a request for it costs next to nothing. The browser then opens a connection with
that token: the page is made then, and sent once. Behind a proxy, another server may receive that connection.
"""

import asyncio
import contextlib
import logging
import time
from collections import deque
from collections.abc import AsyncIterator, Callable
from typing import Any

from bokeh.protocol.exceptions import ProtocolError
from tornado.web import HTTPError

from railjoule.dashboard.library_workarounds import (
    PageAnswer,
    PageConnection,
    begin_as,
    forget_begun,
    has_page,
    is_gone,
    make_token,
    note_pulled,
    page_of_token,
)

LOG = logging.getLogger(__name__)
OPENS_WITHIN_S = 5.0
"""A page whose connection has not come by then is taken for one that was left."""
BREATH_S = 0.05
"""Between two pages that open, those that are open have their turns."""
MOVE_S = 0.5
"""A page that opens lets those go first that have waited for a result no longer than this."""
LOOK_AGAIN_S = 0.005
TOKEN = "@token@"
"""Stands where the token of a page comes."""
MARK = "railjoule"
"""Variables of the template, equal for all pages, see `first_paint` in shell.py."""
COULD_NOT, TRY_LATER = 1011, 1013
FORBIDDEN = 403


class Opening:
    """State shared by the opening pages of one server.

    Parameters
    ----------
    html : str
        First answer to each browser, with TOKEN where its own comes.
    most : int or None
        How many pages may be open at a time; None for any number.
    count_open : callable
        Returns how many pages are open.
    others_wait : callable
        Returns whether an open page waits for a result, and not longer than so many seconds.
    """

    def __init__(
        self,
        html: str,
        most: int | None = None,
        count_open: Callable[[], int] = lambda: 0,
        others_wait: Callable[[float], bool] = lambda _: False,
    ) -> None:
        self._before, self._after = html.split(TOKEN)
        self._most, self._count_open, self._others_wait = most, count_open, others_wait
        self._one = asyncio.Lock()
        self._answered: deque[float] = deque()
        self._opened: deque[float] = deque()

    def html(self, token: str) -> str:
        """Return the first answer to a browser."""
        self._answered.append(time.monotonic())
        return "".join((self._before, token, self._after))

    @property
    def taken_places(self) -> int:
        """Number of pages that are open or about to open."""
        return self._count_open() + self._awaited()

    @property
    def has_place(self) -> bool:
        """Whether a page may open whose connection has come: there is a place, or one was kept for it."""
        return self._most is None or self._awaited() > 0 or self._count_open() < self._most

    def _awaited(self) -> int:
        """Return how many more pages were answered of late than were opened."""
        since = time.monotonic() - OPENS_WITHIN_S
        for times in (self._answered, self._opened):
            while times and times[0] < since:
                times.popleft()
        # behind a proxy, pages may open here that another server has answered
        return max(len(self._answered) - len(self._opened), 0)

    @contextlib.asynccontextmanager
    async def turn(self) -> AsyncIterator[None]:
        """Let one page be made at a time, and the others have their turns before."""
        async with self._one:
            await asyncio.sleep(BREATH_S)
            until = time.monotonic() + MOVE_S
            while self._others_wait(MOVE_S) and time.monotonic() < until:
                await asyncio.sleep(LOOK_AGAIN_S)
            yield
            self._opened.append(time.monotonic())


class PageHandler(PageAnswer):
    """Answers requests for the page."""

    def initialize(self, opening: Opening, **kwargs: Any) -> None:
        """Take what pages that open have in common."""
        super().initialize(**kwargs)
        self._opening = opening

    async def get(self, *_: Any, **__: Any) -> None:
        """Answer with what is the same for all, and a token."""
        if not self.request.path.endswith("/"):
            query = f"?{self.request.query}" if self.request.query else ""
            self.redirect(f"{self.request.path}/{query}")
            return
        # a token is for one page
        self.set_header("Cache-Control", "no-store")
        self.set_header("Content-Type", "text/html")
        self.write(self._opening.html(make_token(self)))


class PageSocket(PageConnection):
    """The connection of a page, with which its state begins."""

    def initialize(self, opening: Opening, **kwargs: Any) -> None:
        """Take what pages that open have in common."""
        super().initialize(**kwargs)
        self._opening = opening

    def open(self, *args: Any, **kwargs: Any) -> None:
        """Begin with the token that the browser names; refuse one that is none in a line of the log."""
        try:
            super().open(*args, **kwargs)
        # a token that is no base64, no JSON, without a session, or too old
        except (ValueError, TypeError, AttributeError, LookupError, ProtocolError) as error:
            # not the error's own words, which may hold what was sent
            raise HTTPError(FORBIDDEN, "a connection without a valid token: %s", type(error).__name__) from None

    async def _async_open(self, token: str) -> None:
        async with self._opening.turn():
            # a window that is closed while others open costs nothing
            if is_gone(self):
                return
            if not self._opening.has_place:
                self.close(TRY_LATER, "all places are taken")
                return
            try:
                begin_as(self.request, page_of_token(token))
                await super()._async_open(token)
            except Exception:
                LOG.exception("a page could not be opened")
                forget_begun(self, token)
            else:
                if has_page(self, MARK):
                    return
                LOG.error("a page could not be opened: what went wrong stands above")
            self.close(COULD_NOT, "the page could not be opened")

    async def _handle(self, message: Any) -> Any:
        work = await super()._handle(message)
        note_pulled(self, message)
        return work
