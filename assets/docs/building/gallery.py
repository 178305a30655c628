"""Examples run while their pages are built; the lines that they print and their pictures are put below each."""

import contextlib
import io
import re
import traceback
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
from sphinx.application import Sphinx
from sphinx.errors import ExtensionError

from building.colours import NAMES, with_variables
from railjoule.dashboard.look.tokens import FONT, LIGHT

mpl.use("svg")
from matplotlib import pyplot as plt

PAGES = ("gallery", "explanation/proof")
EXAMPLE = re.compile(r"^## (?P<title>[^\n]+)$(?:(?!^## ).)*?^```python\n(?P<code>.*?)^```$", re.MULTILINE | re.DOTALL)
STYLE: dict[str, Any] = {
    "figure.figsize": (7.2, 3.0),
    "figure.facecolor": "none",
    "figure.constrained_layout.use": True,
    "savefig.transparent": True,
    "axes.facecolor": "none",
    "axes.edgecolor": LIGHT["line2"],
    "axes.labelcolor": LIGHT["ink2"],
    "axes.titlecolor": LIGHT["ink"],
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.prop_cycle": mpl.cycler(color=[LIGHT[name] for name in NAMES]),
    "grid.color": LIGHT["grid"],
    "text.color": LIGHT["ink"],
    "xtick.color": LIGHT["ink2"],
    "ytick.color": LIGHT["ink2"],
    "legend.facecolor": LIGHT["surface"],
    "legend.edgecolor": "none",
    "legend.framealpha": 0.85,
    "lines.linewidth": 1.8,
    "font.family": "sans-serif",
    "font.size": 9.5,
    # text stays text: it is read aloud, searched for, and set in the page's font
    "svg.fonttype": "none",
    "svg.hashsalt": "railjoule",
}


@dataclass(frozen=True)
class Example:
    """One example: its heading, its code, what it printed, and its picture in light colours or nothing."""

    title: str
    code: str
    printed: str
    svg: str


def run_example(title: str, code: str) -> Example:
    """Run the code of an example by itself.

    Raises
    ------
    ExtensionError
        If it fails, or draws nothing.
    """
    printed = io.StringIO()
    with mpl.rc_context(STYLE), contextlib.redirect_stdout(printed):
        try:
            exec(compile(code, title, "exec"), {"__name__": "__example__"})
        except Exception as error:
            raise ExtensionError(f"the example {title!r} fails:\n{traceback.format_exc()}") from error
        figures = [plt.figure(number) for number in plt.get_fignums()]
        if len(figures) != 1:
            raise ExtensionError(f"the example {title!r} must draw one picture, and draws {len(figures)}.")
        drawn = io.StringIO()
        # without a date the same code gives the same picture
        figures[0].savefig(drawn, format="svg", metadata={"Date": None, "Creator": None})
        plt.close("all")
    return Example(title, code, printed.getvalue(), _as_part_of_a_page(drawn.getvalue(), title))


def _as_part_of_a_page(svg: str, title: str) -> str:
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r"<metadata>.*?</metadata>", "", svg, flags=re.DOTALL)
    svg = re.sub(r"font: [\d.]+px [^;\"]*|font-family: [^;\"]*", lambda found: _in_our_font(found[0]), svg)
    svg = re.sub(r'(<svg[^>]*?) height="[^"]*"', r"\1", svg, count=1)
    svg = re.sub(r'(<svg[^>]*?) width="[^"]*"', r"\1", svg, count=1)
    # matplotlib's own style sheet would hold for the whole page
    svg = re.sub(r"<style.*?</style>", "", svg, flags=re.DOTALL)
    named = (
        f'<svg role="img" aria-label="Picture of the example: {title}" '
        'style="stroke-linejoin: round; stroke-linecap: butt" '
    )
    return "\n".join(line for line in svg.replace("<svg ", named, 1).splitlines() if line.strip())


def _in_our_font(declared: str) -> str:
    size = re.match(r"font: ([\d.]+px)", declared)
    family = FONT.replace("'", "&#39;")
    return f"font: {size[1]} {family}" if size else f"font-family: {family}"


def find_examples(text: str) -> list[Example]:
    """Return the examples of a page after they have run."""
    return [run_example(found["title"], found["code"]) for found in EXAMPLE.finditer(text)]


def with_results(text: str) -> str:
    """Return a page with the picture and the printed lines below each example."""
    for example in find_examples(text):
        shown = f"```python\n{example.code}```\n"
        below = f"\n```text\n{example.printed}```\n" if example.printed else ""
        picture = f'\n````{{raw}} html\n<figure class="picture">{with_variables(example.svg)}</figure>\n````\n'
        text = text.replace(shown, shown + below + picture, 1)
    return text


def _fill(app: Sphinx, page: str, source: list[str]) -> None:
    if page in PAGES and app.builder.format == "html":
        source[0] = with_results(source[0])


def setup(app: Sphinx) -> dict[str, bool]:
    """Let the examples run when their page is read."""
    app.connect("source-read", _fill)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
