import logging
import re
import sys
from collections.abc import Iterator

import pytest

from railjoule.dashboard.server.logs import Dated, write_down


@pytest.fixture
def _as_before() -> Iterator[None]:
    """Give the loggers back what they had."""
    root, own = logging.getLogger(), logging.getLogger("railjoule")
    handlers, level = list(root.handlers), own.level
    # one that another test has left writes to a stream that is closed
    root.handlers[:] = [handler for handler in handlers if not isinstance(handler, Dated)]
    yield
    root.handlers[:] = handlers
    own.setLevel(level)


@pytest.mark.usefixtures("_as_before")
def test_each_line_is_written_once_with_its_time(capsys: pytest.CaptureFixture[str]) -> None:
    write_down()
    write_down()
    for handler in logging.getLogger().handlers:
        if isinstance(handler, Dated):
            handler.setStream(sys.stderr)
    logging.getLogger("railjoule.dashboard.work.events").info("closed page=Drive")
    # a library that no other test has told to be quiet
    logging.getLogger("a_library").warning("404 GET /nope")
    lines = capsys.readouterr().err.splitlines()
    date = r"\d{4}-\d\d-\d\d \d\d:\d\d:\d\d"
    assert [bool(re.fullmatch(f"{date} (closed page=Drive|404 GET /nope)", line)) for line in lines] == [True, True]
