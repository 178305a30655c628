"""Text of HTML, as a reader sees it."""

import html
import re


def plain(markup: str) -> str:
    """Return the text of HTML without tags, with one space between words."""
    return " ".join(html.unescape(re.sub("<[^>]+>", " ", markup)).split())
