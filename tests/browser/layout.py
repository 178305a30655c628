"""What is cut off, what scrolls sideways, which markup is read as text, and where a hole gapes within a page."""

import contextlib
from typing import Any

from browser.user import User

LARGEST_HOLE_PX = 330
"""As high as the usual chart of a page."""
WALK = """
const all = [];
const walk = (root) => {
  for (const element of root.querySelectorAll("*")) {
    all.push(element);
    if (element.shadowRoot) walk(element.shadowRoot);
  }
};
walk(document);
const seen = (element) => element.checkVisibility({checkOpacity: true, checkVisibilityCSS: true,
  contentVisibilityAuto: true}) && element.getClientRects().length > 0;
"""
CUT = (
    "() => {"
    + WALK
    + """
  const whole = (element) => {
    for (let e = element; e; e = e.parentElement ?? e.getRootNode().host) { if (e.title) return true; }
    return false;
  };
  return all.filter((element) => {
    const style = getComputedStyle(element);
    if (!["hidden", "clip"].includes(style.overflowX) || style.clipPath !== "none") return false;
    if (element.clientWidth < 2 || element.scrollWidth <= element.clientWidth + 1 || !seen(element)) return false;
    const text = element.tagName === "INPUT" ? element.value
      : [...element.childNodes].filter((node) => node.nodeType === 3).map((node) => node.data).join("").trim();
    return text && !whole(element);
  }).map((element) => `${element.className}: ${(element.value ?? element.textContent).trim().slice(0, 60)}`);
}"""
)
HOLES = (
    "([least]) => {"
    + WALK
    + """
  const sheet = document.querySelector("main") ?? document.body;
  const edge = sheet.getBoundingClientRect();
  const tags = ["CANVAS", "svg", "IMG", "INPUT", "BUTTON", "LABEL", "TABLE"];
  const rows = all.filter((element) => seen(element) && (tags.includes(element.tagName)
    || [...element.childNodes].some((node) => node.nodeType === 3 && node.data.trim())))
    .map((element) => element.getBoundingClientRect())
    .filter((box) => box.width > 1 && box.height > 1 && box.left >= edge.left - 1 && box.right <= edge.right + 60)
    .map((box) => [box.top, box.bottom]).sort((a, b) => a[0] - b[0]);
  const holes = [];
  let end = rows.length ? rows[0][1] : 0;
  for (const [top, bottom] of rows) {
    if (top - end > least) holes.push([Math.round(end), Math.round(top)]);
    end = Math.max(end, bottom);
  }
  return holes;
}"""
)
MARKUP = (
    "() => {"
    + WALK
    + """
  const escaped = /<\\/?[a-z]+[\\s>]|&(?:lt|gt|amp|quot|#\\d+);/;
  return all.filter((element) => !["SCRIPT", "STYLE", "TEMPLATE"].includes(element.tagName) && seen(element))
    .flatMap((element) => [...element.childNodes].filter((node) => node.nodeType === 3 && escaped.test(node.data)))
    .map((node) => node.data.trim().slice(0, 60));
}"""
)
SIDEWAYS = (
    "() => {"
    + WALK
    + """
  const wide = all.filter((element) => ["auto", "scroll"].includes(getComputedStyle(element).overflowX)
    && seen(element) && element.clientWidth > 0.8 * innerWidth && element.clientHeight > 0.5 * innerHeight
    // a table that says of itself that it scrolls may
    && element.getAttribute("role") !== "region" && element.scrollWidth > element.clientWidth + 1);
  const whole = document.scrollingElement;
  return [...wide.map((element) => `${element.tagName}.${element.className}`),
    ...(whole.scrollWidth > innerWidth ? ["the page"] : [])];
}"""
)


def layout_faults(user: User, page: str) -> dict[str, Any]:
    """Return what is and stays wrong with the layout of the page in sight, by its name."""
    # a surface leaves a hole until its library is there
    with contextlib.suppress(AssertionError):
        user.wait_until(lambda: not _faults(user))
    return {f"{page}, {name}": told for name, told in _faults(user).items()}


def _faults(user: User) -> dict[str, Any]:
    found = {
        "cut": user.page.evaluate(CUT),
        "sideways": user.page.evaluate(SIDEWAYS),
        "markup": user.page.evaluate(MARKUP),
        "holes": user.page.evaluate(HOLES, [LARGEST_HOLE_PX]),
    }
    return {name: told for name, told in found.items() if told}
