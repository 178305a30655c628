"""Whether a page is idle, as its browser shows it: for tests that wait for the answer to a change."""

from playwright.sync_api import Page

from railjoule.dashboard.work.worker import LATE_MS

LOOK_MS = 50
QUIET_MS = LATE_MS + 100
"""A result that takes longer is marked as late, and the bar `.working` is shown."""
WATCH = """
(() => {
  // Bokeh sends the head of each message as a frame of its own; the server's answer names that message
  const unanswered = new Set(), watched = new WeakSet(), {send} = WebSocket.prototype;
  let last_ms = 0;
  const id = (data, name) => {
    const found = typeof data === "string" && data.length < 1000 && data.startsWith("{") ? data : "{}";
    try { return JSON.parse(found)[name] ?? null; } catch { return null; }
  };
  WebSocket.prototype.send = function (data) {
    if (!watched.has(this)) {
      watched.add(this);
      this.addEventListener("message", (event) => {
        unanswered.delete(id(event.data, "reqid"));
        last_ms = performance.now();
      });
      this.addEventListener("close", () => unanswered.clear());
    }
    const sent = id(data, "msgid");
    if (sent !== null) { unanswered.add(sent); }
    last_ms = performance.now();
    return send.call(this, data);
  };
  const in_sight = (element) => {
    const {top, bottom, width} = element.getBoundingClientRect();
    return width > 0 && bottom > 0 && top < window.innerHeight && element.checkVisibility();
  };
  window.is_idle = (quiet_ms) => unanswered.size === 0 && performance.now() - last_ms > quiet_ms
    && document.getElementById("rj-first") === null && railjoule.deep(".working:not([hidden])").length === 0
    && !railjoule.deep(".rj-undrawn").some(in_sight);
})();
"""


def watch(page: Page) -> None:
    """Let a page count the messages that the server has not answered; before it is opened."""
    page.add_init_script(WATCH)


def wait_until_idle(page: Page, timeout_ms: float) -> None:
    """Wait until the server has answered all messages, nothing is computed, and the charts in sight are drawn."""
    asked = "(quiet_ms) => window.is_idle(quiet_ms)"
    page.wait_for_function(asked, arg=QUIET_MS, timeout=timeout_ms, polling=LOOK_MS)
