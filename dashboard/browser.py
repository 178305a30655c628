"""What only the browser knows, and what only it can mend.

It tells the width of the window, the wish for dark colours and which charts are in sight; it names what screen
readers would otherwise find without a name.
"""

from collections.abc import Callable
from typing import Any

import param
from panel.custom import JSComponent

DEEP_JS = """
const all_roots = () => {
  const found = [];
  const walk = (root) => {
    found.push(root);
    for (const element of root.querySelectorAll("*")) { if (element.shadowRoot) walk(element.shadowRoot); }
  };
  walk(document);
  return found;
};
const deep = (selector, roots = all_roots()) => roots.flatMap((root) => [...root.querySelectorAll(selector)]);
const chart_of = (element) => [...element.classList].find((name) => name.startsWith("rj-chart-"))?.slice(9);
"""
"""Finds all shadow roots and elements in them, and the name of a chart."""
ESM = (
    DEEP_JS
    + """
export function render({model}) {
  const dark = window.matchMedia("(prefers-color-scheme: dark)");
  const theme = () => document.documentElement.classList.toggle("rj-dark", model.dark);
  model.on("dark", theme);
  model.on("started", () => document.documentElement.classList.add("rj-started"));
  theme();
  const tell = () => {
    model.window_width = window.innerWidth;
    model.wants_dark = dark.matches;
  };
  window.addEventListener("resize", tell);
  dark.addEventListener("change", tell);
  tell();

  const seen = new Map();
  const observer = new IntersectionObserver((entries) => {
    for (const entry of entries) { seen.set(entry.target, entry.isIntersecting); }
    const in_sight = [...seen].filter(([element, visible]) => visible && element.isConnected);
    const names = [...new Set(in_sight.map(([element]) => chart_of(element)))].sort();
    if (JSON.stringify(names) !== JSON.stringify(model.charts_in_sight)) { model.charts_in_sight = names; }
  }, {rootMargin: "120px"});
  const look = () => {
    const roots = all_roots();
    for (const element of deep(".rj-chart", roots)) {
      if (!seen.has(element)) { seen.set(element, false); observer.observe(element); }
      window.railjoule_equip?.(element);
    }
    for (const element of [...seen.keys()]) {
      if (!element.isConnected) { seen.delete(element); observer.unobserve(element); }
    }
    for (const bar of deep("[role=progressbar]:not([aria-label])", roots)) {
      bar.setAttribute("aria-label", "Progress");
    }
    for (const region of deep(".main-content:not([tabindex])", roots)) {
      region.tabIndex = 0;
      region.setAttribute("role", "region");
      region.setAttribute("aria-label", "Page in sight");
    }
    // the library lays wide margins over those of a scene
    for (const scene of deep(".js-plotly-plot", roots)) {
      if (scene.layout?.margin?.l) { window.Plotly.relayout(scene, {margin: {l: 0, r: 0, t: 0, b: 2}}); }
    }
    // keys do nothing in a figure, whose words stand on its frame
    for (const layer of deep(".bk-events[tabindex='0']", roots)) { layer.tabIndex = -1; }
    // a download leaves the link behind that began it, without a name
    for (const link of deep("a[download]:empty", roots)) { link.hidden = true; }
    for (const heading of deep("h5", roots)) {
      if (!heading.textContent.trim()) { heading.setAttribute("role", "presentation"); }
    }
  };
  look();
  const timer = setInterval(look, 300);
  model.on("remove", () => {
    clearInterval(timer);
    observer.disconnect();
    window.removeEventListener("resize", tell);
    dark.removeEventListener("change", tell);
  });
  return document.createElement("span");
}
"""
)

FIRST_CHARTS = ("energy", "line", "phases", "speed")
"""What a desktop window shows at first; the page is sent with these charts drawn."""


class Browser(JSComponent):
    """The reader of the page's browser.

    It speaks before the page has loaded, and what is changed on the page until then never reaches the browser; so
    those who `follow` it hear nothing before `start`.
    """

    window_width = param.Integer(default=1280, doc="Width of the window [px].")
    wants_dark = param.Boolean(default=False, doc="Whether the system asks for dark colours.")
    dark = param.Boolean(default=False, doc="Whether the page is dark.")
    started = param.Boolean(default=False, doc="Whether the page has loaded.")
    charts_in_sight = param.List(default=list(FIRST_CHARTS), doc="Names of the charts in sight.")

    _esm = ESM

    def __init__(self, **params: object) -> None:
        super().__init__(**params)
        self._followers: list[tuple[list[str], list[Any], Callable[[], None]]] = []

    def follow(self, names: list[str], callback: Callable[[], None]) -> None:
        """Call back when any of the named values changes, and when the page has loaded if any has changed by then."""
        self._followers.append((names, self._values(names), callback))
        self.param.watch(lambda *_: callback() if self.started else None, names)

    def start(self) -> None:
        """Begin to speak: the page has loaded."""
        self.started = True
        for names, known, callback in self._followers:
            if self._values(names) != known:
                callback()

    def _values(self, names: list[str]) -> list[Any]:
        return [getattr(self, name) for name in names]
