"""The code page of a text that is not UTF-8: named by the user, or found by the letters that it would have.

A code page is possible where all letters are those of one language that it was made for. What several possible ones
read alike is taken; where they differ the user must name one.
"""

import re
import unicodedata
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from railjoule.core.errors import EncodingError, RailjouleError, ScenarioError
from railjoule.core.imports.findings import Finding
from railjoule.core.scenario._sentences import show

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
"""What tables of any language hold beside letters."""
_SPACES = dict.fromkeys(map(ord, SIGNS), " ")
LONGEST_SAMPLE = 200_000
"""Characters by which a code page is judged."""
SIGN_IN_WORD = re.compile(r"[\u00b2\u00b3\u2116\u00a7\u00bd\u20ac][^\W\d_]")
"""Signs before a letter: one of another code page looks like that, and no unit."""
WORD = re.compile(r"[^\W\d_]+")
# level 1 of GB2312 are the 3,755 characters in use, level 2 those of names and books
USUAL_HANZI_SHARE = 0.8


def decoded(name: str, content: bytes, encoding: str) -> tuple[str, list[Finding]]:
    """Return the text of a file, and how its characters were read where it is not Unicode.

    Parameters
    ----------
    name : str
        The file.
    content : bytes
        What it holds.
    encoding : str
        The code page of a file that is not UTF-8; empty where it is to be found.

    Raises
    ------
    EncodingError
        If several code pages are possible, or none.
    ScenarioError
        If the named one is unknown, or the file is not in it.
    """
    if encoding:
        require_code_page(encoding)
    try:
        return content.decode("utf-16" if content.startswith(UTF_16_MARKS) else "utf-8-sig"), []
    except UnicodeDecodeError:
        pass
    if encoding:
        try:
            return content.decode(encoding), []
        except (UnicodeError, ValueError, LookupError) as error:
            raise ScenarioError(f"{name}: not in the code page {encoding}: {error}.") from None
    texts = _possible_texts(content)
    if len(set(texts.values())) != 1:
        found = " and ".join(NAMES[page] for page in texts) or "none of Windows-1250, -1251, -1252 and GBK"
        raise EncodingError(name, f"and {found} {'are possible' if texts else 'is possible'}", tuple(texts))
    page, text = texts.popitem()
    return text, [Finding("reading", f"{name}: not UTF-8, and so read as {NAMES[page]}.")]


def found_code_page(content: bytes) -> str | None:
    """Return the code page in which a file is read that is not Unicode, empty where it is in doubt; None of others."""
    try:
        content.decode("utf-16" if content.startswith(UTF_16_MARKS) else "utf-8-sig")
    except UnicodeDecodeError:
        texts = _possible_texts(content)
        return texts.popitem()[0] if len(set(texts.values())) == 1 else ""
    return None


def require_code_page(encoding: str) -> None:
    """Raise ScenarioError if there is no code page of a name."""
    try:
        # some codecs of Python make no text, and `bytes.decode` refuses them
        b"ab".decode(encoding)
    except (LookupError, UnicodeError, ValueError):
        known = "cp1250, cp1251, cp1252, gbk, latin-1, cp932"
        raise ScenarioError(f"--encoding {show(encoding)} is no code page; name one, such as {known}.") from None


@contextmanager
def encoding_mentioned(findings: Sequence[Finding]) -> Iterator[None]:
    """Add to an error how the characters of its file were read: a wrong code page may be its cause."""
    try:
        yield
    except RailjouleError as error:
        readings = [one.sentence.partition(": ")[2] for one in findings if "not UTF-8" in one.sentence]
        if readings:
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
    """Return whether all that is not ASCII is in GB2312, most of it in its first level."""
    foreign = [letter for letter in text if not letter.isascii()]
    pairs = []
    for letter in foreign:
        try:
            pair = letter.encode("gb2312")
        except UnicodeEncodeError:
            return False
        pairs.append(pair)
    hanzi = [pair for pair in pairs if pair[0] >= 0xB0]
    usual = sum(pair[0] <= 0xD7 for pair in hanzi)
    return bool(hanzi) and usual >= USUAL_HANZI_SHARE * len(hanzi)
