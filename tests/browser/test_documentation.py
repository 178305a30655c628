"""The documentation, built as `./run docs` does it and read in a browser as the dashboard serves it."""

import asyncio
import html.parser
import re
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect
from tornado.httpserver import HTTPServer
from tornado.ioloop import IOLoop
from tornado.testing import bind_unused_port
from tornado.web import Application

import railjoule.core
from browser.findings import grave_findings
from railjoule.dashboard.server.answers import extra_patterns
from railjoule.dashboard.server.guard import guard
from railjoule.dashboard.server.options import ServerOptions

ROOT = Path(__file__).parents[2]
MOST_SECONDS = 90
READ = ("index.html", "gallery.html", "explanation/strategies.html", "reference/python/runs.html", "howto/faq.html")


@dataclass(frozen=True)
class Built:
    """The pages, how long they took, and what was said meanwhile."""

    folder: Path
    seconds: float
    status: int
    said: str


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Built:
    """Build as the script `run` does, but elsewhere."""
    script = (ROOT / "run").read_text(encoding="utf-8").replace("\\\n", " ")
    found = re.search(r"-m sphinx (.*?)\s+assets/docs build/docs", script)
    assert found is not None
    folder = tmp_path_factory.mktemp("docs")
    started = time.monotonic()
    run = subprocess.run(
        [sys.executable, "-m", "sphinx", *found[1].split(), "assets/docs", str(folder)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    return Built(folder, time.monotonic() - started, run.returncode, run.stdout + run.stderr)


@pytest.fixture(scope="module")
def address(built: Built) -> Iterator[str]:
    """Serve the pages with the headers of the dashboard."""
    listening, port = bind_unused_port()
    loops: list[IOLoop] = []
    ready = threading.Event()

    def serve() -> None:
        asyncio.set_event_loop(asyncio.new_event_loop())
        application = Application(extra_patterns(built.folder))
        guard(application, ServerOptions(port=port), lambda: 0)
        HTTPServer(application).add_socket(listening)
        loops.append(IOLoop.current())
        ready.set()
        loops[0].start()
        loops[0].close(all_fds=True)

    thread = threading.Thread(target=serve)
    thread.start()
    ready.wait()
    yield f"http://127.0.0.1:{port}/docs/"
    loops[0].add_callback(loops[0].stop)
    thread.join()


def test_it_builds_without_a_warning_in_time(built: Built) -> None:
    assert (built.said, built.status) == ("", 0)
    assert built.seconds < MOST_SECONDS


def test_the_gallery_has_ten_pictures_that_its_code_drew(built: Built) -> None:
    text = (built.folder / "gallery.html").read_text(encoding="utf-8")
    assert text.count('<figure class="picture"><svg role="img"') == 10
    source = (ROOT / "assets" / "docs" / "gallery.md").read_text(encoding="utf-8")
    codes = re.findall(r"^```python\n(.*?)^```$", source, re.MULTILINE | re.DOTALL)
    assert len(codes) == 10
    assert all(len([line for line in code.splitlines() if line]) <= 14 for code in codes)
    assert "No run uses less than 2.2228 kWh." in text


def test_python_has_all_names_of_the_core_with_their_docstrings(built: Built) -> None:
    pages = (built.folder / "reference" / "python").glob("*.html")
    text = "".join(page.read_text(encoding="utf-8") for page in pages)
    assert [name for name in railjoule.core.__all__ if f'id="railjoule.{name}"' not in text] == []
    # of the docstring of `solve`, with its unit
    assert "Speeds at the ends of the run [m/s]" in text


@dataclass
class Page(html.parser.HTMLParser):
    """What a page leads to, what it loads, and where it can be entered."""

    links: set[str] = field(default_factory=set)
    loaded: set[str] = field(default_factory=set)
    anchors: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        super().__init__()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = {name: value or "" for name, value in attrs}
        if "src" in values or values.get("rel") == "stylesheet":
            self.loaded.add(values.get("src", values.get("href", "")))
        elif "href" in values:
            self.links.add(values["href"])
        if "id" in values:
            self.anchors.add(values["id"])


def test_no_link_is_dead_and_nothing_is_loaded_from_elsewhere(built: Built) -> None:
    pages: dict[Path, Page] = {}
    for path in built.folder.rglob("*.html"):
        pages[path] = Page()
        pages[path].feed(path.read_text(encoding="utf-8"))
    assert len(pages) > 25
    for path, page in pages.items():
        for loaded in page.loaded:
            assert ":" not in loaded, loaded
            assert (path.parent / loaded.partition("?")[0]).is_file(), (path, loaded)
        for link in page.links:
            if re.match(r"https?:|mailto:|data:,$", link):
                continue
            place, _, anchor = link.partition("#")
            target = (path.parent / place).resolve() if place else path
            assert target.is_file(), (path, link)
            if anchor and target in pages:
                assert anchor in pages[target].anchors, (path, link)


@pytest.mark.nightly
@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [1280, 390])
def test_pages_are_read_in_any_window_under_the_content_policy(
    address: str, chromium: Browser, scheme: str, width: int
) -> None:
    context = chromium.new_context(viewport={"width": width, "height": 900}, color_scheme=scheme)
    page = context.new_page()
    told: list[str] = []
    asked: list[str] = []
    page.on("console", lambda message: told.append(message.text))
    page.on("pageerror", lambda error: told.append(str(error)))
    page.on("request", lambda request: asked.append(request.url))
    for name in READ:
        page.goto(address + name)
        expect(page.get_by_role("heading", level=1)).to_be_visible()
        assert page.evaluate("document.documentElement.scrollWidth") <= width, name
        assert grave_findings(page) == {}, name
    assert told == []
    assert [url for url in asked if not url.startswith((address, "data:"))] == []
    context.close()


def test_search_finds_a_page(address: str, chromium: Browser) -> None:
    page = chromium.new_page()
    page.goto(address)
    page.get_by_role("textbox").fill("Pontryagin")
    page.get_by_role("button", name="Go").click()
    page.get_by_role("link", name="The strategies and their mathematics").first.click()
    expect(page.get_by_role("heading", level=1)).to_contain_text("The strategies and their mathematics")
    page.close()


def test_formulas_are_drawn_by_the_browser(address: str, chromium: Browser) -> None:
    page = chromium.new_page()
    page.goto(address + "explanation/strategies.html")
    # a fraction is taller than a line of text only where MathML is drawn
    assert page.locator(".formula math mfrac").first.evaluate("one => one.getBoundingClientRect().height") > 24
    page.close()
