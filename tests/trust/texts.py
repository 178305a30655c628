"""Section 5 without a server: links, scenario texts, names and cells that strangers wrote."""

import base64
import io
import json
import time
import zlib
from collections.abc import Callable

import pandas

from railjoule.core import RailjouleError, load_scenario
from railjoule.core.budget import PAGE, within
from railjoule.core.csv_text import csv_of_table, plain_table
from railjoule.core.scenario import format_scenario
from railjoule.dashboard.keep.dropped import scenario_text
from railjoule.dashboard.keep.embedded import embedded
from railjoule.dashboard.keep.link import read_link
from railjoule.dashboard.state.opened import outcome_of
from tests.trust.rows import Found, Row

LONGEST_S = 2.0
"""A refusal that takes longer keeps other pages waiting, though a thread reads long texts."""


def packed(content: bytes) -> str:
    """Return bytes as a link holds them."""
    return "~" + base64.urlsafe_b64encode(zlib.compress(content, 9)).decode().rstrip("=")


def timed(ask: Callable[[], str]) -> Found:
    """Return the sentence with which something is refused, and how long that takes."""
    # of the processor: what else runs on the machine is no part of it
    started = time.thread_time()
    said = ask()
    took = time.thread_time() - started
    is_sentence = bool(said) and "\n" not in said and "Traceback" not in said and len(said) < 400
    return Found(f"{took:.2f} s CPU: {said[:110]}", is_sentence and took < LONGEST_S)


def link(text: str) -> Callable[[], Found]:
    """Return what finds how a link is refused."""
    return lambda: timed(lambda: read_link(text).refusal)


def scenario(text: Callable[[], str]) -> Callable[[], Found]:
    """Return what finds how a page refuses a scenario."""

    def find() -> Found:
        content = text()

        def ask() -> str:
            outcome_of.cache_clear()
            try:
                found = outcome_of(scenario_text(content, "file.toml"))
            except RailjouleError as refusal:
                return str(refusal)
            return str(found) if isinstance(found, RailjouleError) else ""

        return timed(ask)

    return find


def good_text() -> str:
    """Return a scenario that is taken."""
    return format_scenario(load_scenario("metro-with-limit"))


def with_line(table: str) -> str:
    """Return a scenario with another line."""
    vehicle = "[vehicle]\npreset = 'metro-81-7036'\n[timetable]\ntravel_time_s = 100\n"
    return f"{vehicle}[line]\n{table}\n"


def sections(count: int) -> str:
    """Return a line of many sections."""
    return with_line("sections = [" + "{length_m = 10}," * count + "]")


NUMBERS = ("nan", "inf", "-5", "1e308", "1e400", "true", "2020-01-01", "9" * 5000)


def hostile_numbers() -> Found:
    """Try numbers that are none."""
    wrong = []
    for number in NUMBERS:
        text = good_text().replace("travel_time_s = ", f"travel_time_s = {number} #", 1)
        outcome_of.cache_clear()
        with within(PAGE):
            found = outcome_of(text)
        if not isinstance(found, RailjouleError) or "\n" in str(found):
            wrong.append(number[:12])
    return Found(f"{len(NUMBERS) - len(wrong)} of {len(NUMBERS)} refused {wrong or ''}", not wrong)


def other_files() -> Found:
    """Try to have files of the server read by a scenario that comes as a text."""
    names = ("../../etc/passwd", "/etc/passwd", "file:///etc/passwd", "//host/share")
    texts = [with_line(f"file = '{name}'") for name in names]
    texts.append("[vehicle]\npreset = '../../../etc/passwd'\n[line]\npreset = 'liashenko-ii'\n")
    said = [str(outcome_of(text)) for text in texts]
    leaks = [words for words in said if "root:" in words]
    refused = sum(isinstance(outcome_of(text), RailjouleError) for text in texts)
    return Found(f"{refused} of {len(texts)} refused, {len(leaks)} leaks", refused == len(texts) and not leaks)


def misleading_names() -> Found:
    """Try names that turn the text around them."""
    signs = ("\u202e", "\u2066", "\u0000", "\u2028", "\u001b")
    refused = 0
    for sign in signs:
        try:
            load_scenario("metro-with-limit", {"title": f"a{sign}b"})
        except RailjouleError as error:
            refused += sign not in str(error)
    return Found(f"{refused} of {len(signs)} refused, none shown", refused == len(signs))


def formulas() -> Found:
    """Write cells that a spreadsheet would run, and read them again."""
    table = pandas.DataFrame({"name": ["=1+1", "+cmd", "-cmd", "@SUM", "\t=1", "\r=1"], "x": [-3.2, 1, 2, 3, 4, 5]})
    text = csv_of_table(table)
    read = pandas.read_csv(io.StringIO(text, newline=""))
    guarded = all(str(name).startswith("'") for name in read["name"])
    same = plain_table(read).equals(table)
    return Found(f"guarded {guarded}, read back equal {same}", guarded and same and read["x"][0] == -3.2)


def report_with_a_script() -> Found:
    """Take the scenario of a report, and nothing else of it."""
    page = f"<html><script>window.pwned=1</script><img src=x onerror=alert(1)>{embedded(good_text())}</html>"
    taken = scenario_text(page, "report.html")
    clean = "pwned" not in taken and "onerror" not in taken
    return Found("only its TOML is taken" if clean else "its HTML is taken", clean and taken == good_text())


DEEP = '{"a":' + "[" * 900 + "]" * 900 + "}"
ROWS = (
    Row("5", "bomb behind # (1 GB packed)", "refused in a sentence", link(f"#v=1&toml={packed(bytes(50_000_000))}")),
    Row("5", "link of 600 keys", "refused in a sentence", link("?v=1&" + "&".join(f"k{n}=1" for n in range(600)))),
    Row("5", "link of 2.1 MB", "refused in a sentence", link("?v=1&toml=" + "a" * 2_100_000)),
    Row("5", "edits nested 900 deep", "RecursionError, empty page", link(f"?v=1&edits={packed(DEEP.encode())}")),
    Row("5", "number of 5000 digits in a link", "refused in a sentence", link("?v=1&load_percent=" + "9" * 5000)),
    Row("5", "link of another version", "not tried", link("?v=2&load_percent=1")),
    Row("5", "dotted key of 50,000 parts", "31 s, 7.2 GB, HTTP 500", scenario(lambda: ".".join("a" * 50_000) + "=1")),
    Row("5", "dotted header of 50,000 parts", "not tried", scenario(lambda: f"[{'.'.join('a' * 50_000)}]")),
    Row("5", "edit of 100,000 parts", "RecursionError, empty page", scenario(lambda: ".".join("a" * 100_000) + "=1")),
    Row("5", "lists nested 5000 deep", "refused in a sentence", scenario(lambda: "a=" + "[" * 5000 + "]" * 5000)),
    Row("5", "inline tables nested 5000 deep", "refused", scenario(lambda: "a=" + "{a=" * 5000 + "1" + "}" * 5000)),
    Row("5", "file of 11 MB", "refused in a sentence", scenario(lambda: "#" * 11_000_000)),
    Row("5", "500,000 keys", "refused after 4.2 s", scenario(lambda: "\n".join(f"k{n}=1" for n in range(500_000)))),
    Row("5", "100,000 sections", "taken, 2.4 s of the event loop", scenario(lambda: sections(100_000))),
    Row("5", "raw NUL, lone surrogate", "refused in a sentence", scenario(lambda: 'title = "\x00"')),
    Row("5", "numbers that are none", "refused in a sentence", hostile_numbers),
    Row("5", "files of the server by line.file, preset", "refused; nothing leaks", other_files),
    Row("5", "dropped report with script and onerror", "only its TOML is taken", report_with_a_script),
    Row("5", "names that turn the text around them", "accepted and shown", misleading_names),
    Row("5", "cells that are formulas, in CSV", "not tried", formulas),
    Row(
        "5",
        "JSON of 100,000 entries in a link",
        "not tried",
        link("?v=1&edits=" + packed(json.dumps({"line.sections": [{"length_m": 1.0}] * 100_000}).encode())),
    ),
)
