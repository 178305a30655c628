"""Files that an import reads: as bytes, as text, as JSON; and the code page of a text that is not UTF-8.

A code page is possible if all letters are those of one language that it was made for. A file is read if all possible
code pages give the same text; otherwise the user must name one.
"""

import json
import re
import unicodedata
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NoReturn

from railjoule.core.errors import EncodingError, RailjouleError, ScenarioError
from railjoule.core.imports.findings import Finding
from railjoule.core.scenario._sentences import show
from railjoule.core.scenario.text_file import read_bytes

# a whole network's speed limits with the shape of each line are about 30 MB
MAX_BYTES = 50_000_000


UTF_16_MARKS = (b"\xff\xfe", b"\xfe\xff")
LETTERS = {
    # French and Dutch; German; Danish and Norwegian; Swedish and Finnish; Icelandic; Spanish and Portuguese; Italian
    "cp1252": ("àâçèéêëîïôœùûüÿ", "äöüßé", "æøåéèòóôü", "åäöéü", "áéíóúýþæðö", "áéíóúüñçàâêôãõ", "àèéìíîòóùú"),
    # Polish; Czech and Slovak; Hungarian; Croatian and Slovene; Romanian; Albanian
    "cp1250": ("ąćęłńóśźż", "áčďéěíňóřšťúůýžäľô", "áéíóöőúüű", "čćđšž", "ăâîşţ", "çë"),
    "cp1251": ("абвгдеёжзийклмнопрстуфхцчшщъыьэюя", "абвгґдеєжзиіїйклмнопрстуфхцчшщьюя",
               "абвгдђежзијклљмнњопрстћуфхцчџш", "абвгдеёжзійклмнопрстуўфхцчшыьэюя"),
}  # fmt: skip
"""Letters of languages by code page, beside a to z."""
NAMES = {"gb18030": "GBK", "cp1250": "Windows-1250", "cp1251": "Windows-1251", "cp1252": "Windows-1252"}
"""The last of those that read a file alike is the one that is named."""
SIGNS = frozenset(
    "\u2030\u00b0\u00b2\u00b3\u00b5\u00b1\u2013\u2014\u2018\u2019\u201c\u201d\u201e\u2026\u00b7\u00a7\u00ab\u00bb\u00bd\u20ac\u2116\u00a0"
)
"""Signs of tables in any language, beside letters."""
_SPACES = dict.fromkeys(map(ord, SIGNS), " ")
LONGEST_SAMPLE = 200_000
"""Characters by which a code page is judged."""
SIGN_IN_WORD = re.compile(r"[\u00b2\u00b3\u2116\u00a7\u00bd\u20ac][^\W\d_]")
"""Signs before a letter: one of another code page looks like that, and no unit."""
WORD = re.compile(r"[^\W\d_]+")
# level 1 of GB2312 are the 3,755 characters in use, level 2 those of names and books
USUAL_HANZI_SHARE = 0.8


@dataclass(frozen=True)
class SourceFile:
    """A file by its name and content, so that an uploaded one is read like one on disk.

    `encoding` is its code page if it is a text but not UTF-8; empty if that is to be found. `sheet` is that of a
    workbook if it is read as a file of its own.
    """

    name: str
    content: bytes
    encoding: str = ""
    sheet: str = ""

    @classmethod
    def read(cls, path: str | Path, encoding: str = "") -> "SourceFile":
        """Read a file of at most 50 MB; ScenarioError if it is missing or too large."""
        path = Path(path)
        return cls(path.name, read_bytes(path, MAX_BYTES), encoding)


def select_sheet(source: SourceFile, sheet: str) -> SourceFile:
    """Return a sheet of a workbook as a file of its own."""
    return replace(source, name=f"{source.name}, {sheet}", sheet=sheet)


def read_text(source: SourceFile) -> tuple[str, list[Finding]]:
    """Decode a file, with a finding about its code page if that was guessed.

    Raises
    ------
    EncodingError
        If several code pages are possible, or none.
    ScenarioError
        If it is larger than 50 MB or no text, or its code page is unknown or another.
    """
    name, content, encoding = source.name, source.content, source.encoding
    if len(content) > MAX_BYTES:
        raise ScenarioError(f"{name}: larger than the {MAX_BYTES / 1e6:g} MB permitted.")
    try:
        # some codecs of Python make no text, and `bytes.decode` refuses them
        b"ab".decode(encoding or "utf-8")
    except (LookupError, UnicodeError, ValueError):
        known = "cp1250, cp1251, cp1252, gbk, latin-1, cp932"
        raise ScenarioError(f"--encoding {show(encoding)} is no code page; name one, such as {known}.") from None
    findings = []
    text = _unicode_text(content)
    if text is None and encoding:
        try:
            text = content.decode(encoding)
        except (UnicodeError, ValueError, LookupError) as error:
            raise ScenarioError(f"{name}: not in the code page {encoding}: {error}.") from None
    elif text is None:
        texts = _possible_texts(content)
        if len(set(texts.values())) != 1:
            found = " and ".join(NAMES[page] for page in texts) or "none of Windows-1250, -1251, -1252 and GBK"
            raise EncodingError(name, f"and {found} {'are possible' if texts else 'is possible'}", tuple(texts))
        page, text = texts.popitem()
        findings.append(Finding("reading", f"{name}: not UTF-8, and so read as {NAMES[page]}."))
    if "\0" in text:
        raise ScenarioError(f"{name}: not a text file: it holds the character NUL.")
    return text, findings


def read_unicode(source: SourceFile, form: str) -> str:
    """Decode a file in a format that is UTF-8 by definition, or in the code page that the user names.

    Raises
    ------
    ScenarioError
        If it is in neither, larger than 50 MB or no text.
    """
    text, findings = read_text(source)
    if findings:
        raise EncodingError(source.name, f"which {form} is by definition")
    return text


def read_json(source: SourceFile, lists: bool = False) -> Any:
    """Read the table of a JSON file, or if lists are accepted its list.

    Raises
    ------
    ScenarioError
        If it is no JSON, or contains something else.
    """

    def refuse(constant: str) -> NoReturn:
        raise ScenarioError(f"{source.name}: {constant} is not a number that can be used.")

    text = read_unicode(source, "JSON")
    try:
        value = json.loads(text, parse_constant=refuse)
    except json.JSONDecodeError as error:
        raise ScenarioError(f"{source.name}: not JSON: {error.msg} in line {error.lineno}.") from None
    except RecursionError:
        raise ScenarioError(f"{source.name}: its lists or tables are nested too deeply.") from None
    except ValueError:  # of an integer with more than 4300 digits
        raise ScenarioError(f"{source.name}: a number in it has too many digits.") from None
    if not isinstance(value, dict | list if lists else dict):
        raise ScenarioError(f"{source.name}: must be a JSON object, {{...}}.")
    return value


def found_code_page(content: bytes) -> str | None:
    """Find the code page of a file that is not Unicode, empty if it is in doubt; None for other files."""
    if _unicode_text(content) is not None:
        return None
    texts = _possible_texts(content)
    return texts.popitem()[0] if len(set(texts.values())) == 1 else ""


def _unicode_text(content: bytes) -> str | None:
    try:
        return content.decode("utf-16" if content.startswith(UTF_16_MARKS) else "utf-8-sig")
    except UnicodeDecodeError:
        return None


@contextmanager
def encoding_mentioned(findings: Sequence[Finding]) -> Iterator[None]:
    """Add to an error how the characters of its file were read: a wrong code page may be its cause."""
    try:
        yield
    except RailjouleError as error:
        if readings := [one.sentence.partition(": ")[2] for one in findings if "not UTF-8" in one.sentence]:
            sentence = (
                f"{readings[0][:1].upper()}{readings[0][1:-1]}; if that is wrong name another, as --encoding cp1251."
            )
            error.args = (f"{error} {sentence}",)
        raise


def _possible_texts(content: bytes) -> dict[str, str]:
    """Return the text in each code page in which it can be one."""
    texts = {}
    for page in NAMES:
        try:
            text = content.decode(page)
        except UnicodeDecodeError:
            continue
        sample = text[:LONGEST_SAMPLE]
        if _is_chinese(sample) if page == "gb18030" else _is_of_a_language(sample, LETTERS[page]):
            texts[page] = text
    return texts


def _is_of_a_language(text: str, languages: Sequence[str]) -> bool:
    """Return whether all that is not ASCII are letters of one language, in words as people write them, or signs."""
    foreign = {letter for letter in text if not letter.isascii()}
    letters = foreign - SIGNS
    if SIGN_IN_WORD.search(text) or not all(letter.isalpha() for letter in letters):
        return False
    words = [word for word in WORD.findall(text.translate(_SPACES)) if not word.isascii()]
    return all(_is_a_word(word) for word in words) and any(
        all(letter.lower() in language for letter in letters) for language in languages
    )


def _is_a_word(word: str) -> bool:
    """Return whether a word has one script, capitals at its begin or throughout, and if it is Latin plain letters."""
    scripts = {unicodedata.name(letter, "").partition(" ")[0] for letter in word}
    plain = sum(letter.isascii() for letter in word)
    # the accents of a language stand between plain letters
    return (
        len(scripts) == 1
        and (word[1:].islower() or word.isupper() or len(word) == 1)
        and ("LATIN" not in scripts or 3 * plain >= len(word) or len(word) < 3)
    )


def _is_chinese(text: str) -> bool:
    """Tell whether all that is not ASCII is in GB2312, most of it in its first level."""
    foreign = "".join(letter for letter in text if not letter.isascii())
    try:
        first_bytes = foreign.encode("gb2312")[::2]
    except UnicodeEncodeError:
        return False
    hanzi = [byte for byte in first_bytes if byte >= 0xB0]
    usual = sum(byte <= 0xD7 for byte in hanzi)
    return bool(hanzi) and usual >= USUAL_HANZI_SHARE * len(hanzi)
