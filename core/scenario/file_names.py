"""Names of a user's own files: those that every file system takes, and that read as they are written."""

import unicodedata

from railjoule.core.errors import ScenarioError
from railjoule.core.scenario._sentences import show

LONGEST_NAME = 80
# file systems bound the bytes of a name, at 255; a suffix, and the number of a duplicate, must still fit
LONGEST_NAME_BYTES = 200
SIGNS = " -_()+,&'"
"""Allowed beside letters and digits. A dot is not, as it would begin a suffix."""
RESERVED = {"con", "prn", "aux", "nul", *(f"{port}{number}" for port in ("com", "lpt") for number in range(10))}
"""Windows takes them for devices, whatever the suffix."""


def checked_name(text: str) -> str:
    """Return a name as its file bears it, composed and without spaces around it.

    Raises
    ------
    ScenarioError
        If a file system could refuse it, take it for another place, or show it otherwise.
    """
    name = unicodedata.normalize("NFC", text[: 4 * LONGEST_NAME_BYTES]).strip(" ")
    if not name:
        raise ScenarioError("name is empty; it needs at least one letter or digit.")
    if len(text) > LONGEST_NAME or len(name.encode("utf-8", "replace")) > LONGEST_NAME_BYTES:
        raise ScenarioError(
            f"name = {show(name)} is too long: {len(text)} characters of at most {LONGEST_NAME}, in UTF-8 at most "
            f"{LONGEST_NAME_BYTES} bytes."
        )
    wrong = next((sign for sign in name if not _is_allowed(sign)), None)
    if wrong is not None:
        raise ScenarioError(
            f"name = {show(name)} must not have {wrong!r}: letters, digits, spaces and {' '.join(SIGNS.strip())} are "
            "allowed."
        )
    # a hyphen at the start would be an option on the command line
    if not name[0].isalnum():
        raise ScenarioError(f"name = {show(name)} must begin with a letter or a digit.")
    if name.casefold() in RESERVED:
        raise ScenarioError(f"name = {show(name)} must be another one: Windows reserves it for a device.")
    return name


def same_name_key(name: str) -> str:
    """Return what is equal of names that some file system or reader could take for the same."""
    return unicodedata.normalize("NFKC", unicodedata.normalize("NFKC", name).casefold())


def _is_allowed(sign: str) -> bool:
    # letters, digits and the marks on them; what turns or hides text is of the categories Cf and Cc
    return sign in SIGNS or unicodedata.category(sign)[0] in "LNM"
