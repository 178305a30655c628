"""What a reader sees of HTML."""

import html
import re


def plain(markup: str) -> str:
    """Return the text of HTML without its tags, words apart by one space."""
    return " ".join(html.unescape(re.sub("<[^>]+>", " ", markup)).split())
