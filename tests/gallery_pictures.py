"""`python -m tests.gallery_pictures` makes README's pictures of the gallery's examples, in light and dark colours."""

import sys

from tests.documents import DOCS, ROOT, text_of

sys.path.insert(0, str(DOCS))

from building.colours import in_theme
from building.gallery import EXAMPLE, run_example

PICTURES = ROOT / "assets" / "pictures"
SHOWN = {
    "time": "Energy over travel time",
    "day": "What the day costs",
    "supplement": "Distribute the running time supplement of a line",
}
"""The examples that README shows, by the names of their pictures."""


def main() -> None:
    """Draw and write the pictures."""
    codes = {found["title"]: found["code"] for found in EXAMPLE.finditer(text_of("gallery"))}
    for name, title in SHOWN.items():
        svg = run_example(title, codes[title]).svg
        for theme in ("light", "dark"):
            drawn = in_theme(svg, theme) + "\n"
            (PICTURES / f"gallery-{name}-{theme}.svg").write_text(drawn, encoding="utf-8")


if __name__ == "__main__":
    main()
