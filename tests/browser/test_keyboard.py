"""A run through the page with the keyboard alone: everything can be reached, and one sees where one is."""

import re

from playwright.sync_api import BrowserContext, Page, expect

from browser.server import Server
from browser.user import PATIENCE_MS

MAX_STEPS = 150
FOCUS = """() => {
  let element = document.activeElement;
  while (element && element.shadowRoot && element.shadowRoot.activeElement) element = element.shadowRoot.activeElement;
  if (!element || element === document.body) return null;
  const box = element.getBoundingClientRect(), root = element.getRootNode();
  const labels = [
    element.getAttribute("aria-label"),
    root.getElementById(element.getAttribute("aria-labelledby"))?.innerText,
    root.querySelector(`label[for="${CSS.escape(element.id)}"]`)?.innerText,
    element.innerText,
    element.title,
    element.closest("label")?.innerText,
  ];
  const name = (labels.find((label) => label) || "").trim();
  const html = element.outerHTML.slice(0, 160);
  return {name, html, role: element.getAttribute("role") || element.tagName, seen: box.width > 0 && box.height > 0};
}"""
# how often a figure could have had the focus: each of them is looked at five times a second from its first frame on
STOPS = """window.stops_in_figures = 0;
const look = (root) => {
  for (const element of root.querySelectorAll("*")) {
    if (element.matches(".bk-events") && element.tabIndex >= 0) window.stops_in_figures += 1;
    if (element.shadowRoot) look(element.shadowRoot);
  }
};
setInterval(() => look(document), 200);"""


def reach(page: Page, name: str, exact: bool = False) -> None:
    """Go on with the tab key until something of this name has the focus; whatever has it on the way has a name."""
    passed = []
    for _ in range(MAX_STEPS):
        page.keyboard.press("Tab")
        focus = page.evaluate(FOCUS)
        if focus is None:
            continue
        passed.append(f"{focus['role']} {focus['name']!r}")
        assert focus["name"], (passed[-2:], focus["html"])
        # an icon's name stands on a line of its own, hidden from those who listen
        focused = focus["name"].split("\n")[-1]
        if focused == name if exact else focused.startswith(name):
            assert focus["seen"], focus
            return
    raise AssertionError(f"{name} was not reached: {passed}")


def test_from_a_card_to_a_pinned_run_compared(server: Server, window: BrowserContext) -> None:
    page = window.new_page()
    page.add_init_script(STOPS)
    page.set_default_timeout(PATIENCE_MS)
    try:
        page.goto(server.url)
        page.locator("html.rj-started").wait_for()
        expect(page.get_by_role("button", name="Metro, profile II + I")).to_be_visible()
        reach(page, "Metro, profile II + I")
        page.keyboard.press("Enter")
        energy = page.locator(".figure.main:visible .value")
        expect(energy).not_to_be_empty()
        first = energy.inner_text()
        reach(page, "Pin run")
        page.keyboard.press("Enter")
        # a step of its own for undo
        expect(page).to_have_url(re.compile("kept_pins"))
        reach(page, "Travel time, s")
        for _ in range(5):
            page.keyboard.press("ArrowRight")
        expect(energy).not_to_have_text(first)
        page.keyboard.press("Control+z")
        expect(energy).to_have_text(first)
        reach(page, "Compare", exact=True)
        page.keyboard.press("Enter")
        expect(page.get_by_role("heading", level=1, name=re.compile("^Strategies, pinned runs"))).to_be_visible()
        expect(page.get_by_label("Name of pinned run 1")).to_be_visible()
        assert page.evaluate("window.stops_in_figures") == 0
    finally:
        page.close()
