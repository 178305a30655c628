"""Code pages of texts that are not UTF-8, in the languages of those who wrote the papers and of their neighbours."""

import pytest

from railjoule.core.errors import EncodingError, ScenarioError, UnitError
from railjoule.core.imports import SourceFile
from railjoule.core.imports.findings import Finding
from railjoule.core.imports.source_file import encoding_mentioned, found_code_page, read_json, read_text


@pytest.mark.parametrize(
    ("text", "page"),
    [
        ("Початок, км;Кінець, км;Ухил, \u2030\n", "cp1251"),
        ("Начало;Конец;Уклон\n", "cp1251"),
        ("ПИКЕТ;УКЛОН\n", "cp1251"),
        ("początek;koniec;pochylenie \u2030\n", "cp1250"),
        ("prędkość;promień\n", "cp1250"),
        ("Začátek;konec;sklon;rychlost\n", "cp1250"),
        ("起点里程(km),终点里程(km),坡度(\u2030)\n", "gb18030"),
        ("Intensité à la jante;Repère\n", "cp1252"),
        ("Länge;Gefälle;Straße\n", "cp1252"),
        ("Størrelse;på\n", "cp1252"),
        ("slope \u2030;m²;t °C\n", "cp1252"),
    ],
)
def test_a_code_page_is_found_by_the_letters_of_a_language(text, page):
    read, findings = read_text(SourceFile("a.csv", text.encode(page)))
    assert read == text
    assert [finding.kind for finding in findings] == ["reading"]
    assert found_code_page(text.encode(page)) == page


@pytest.mark.parametrize(
    ("text", "page", "likely"),
    [
        # the Hungarian letter is one of Portuguese, the Spanish one of Polish
        ("kezdet;vége;lejtő\n", "cp1250", ("cp1250", "cp1252")),
        ("inicio;fin;año\n", "cp1252", ("cp1250", "cp1252")),
        ("始点,終点,勾配\n", "cp932", ()),
    ],
)
def test_a_code_page_in_doubt_must_be_named(text, page, likely):
    with pytest.raises(
        EncodingError, match=r"^a\.csv: not UTF-8, .*; save it as UTF-8, or name its code page, as "
    ) as caught:
        read_text(SourceFile("a.csv", text.encode(page)))
    assert caught.value.likely == likely
    assert read_text(SourceFile("a.csv", text.encode(page), page)) == (text, [])


def test_a_named_code_page_is_that_of_files_that_are_not_unicode():
    """So that one option does for several files, of which some are UTF-8."""
    for encoding in ("utf-8", "utf-8-sig", "utf-16"):
        assert read_text(SourceFile("a.csv", "Ухил".encode(encoding), "cp1251")) == ("Ухил", [])
    assert found_code_page("Ухил".encode()) is None


@pytest.mark.parametrize("encoding", ["klingon", "hex", "rot13", "zip", "../x", "undefined", "a" * 300])
def test_what_is_no_code_page_is_refused(encoding):
    with pytest.raises(ScenarioError, match=r"^--encoding '.* is no code page; name one, such as "):
        read_text(SourceFile("a.csv", b"from,to\n", encoding))


def test_a_file_that_is_not_in_the_named_code_page_is_refused():
    with pytest.raises(ScenarioError, match=r"^a\.csv: not in the code page gbk: "):
        read_text(SourceFile("a.csv", b"d\xe9,\xff\n", "gbk"))


def test_json_is_unicode_unless_a_code_page_is_named():
    content = '{"name": "Zürich"}'.encode("cp1252")
    with pytest.raises(EncodingError, match=r"^a\.json: not UTF-8, which JSON is by definition; save it as UTF-8, or "):
        read_json(SourceFile("a.json", content))
    assert read_json(SourceFile("a.json", content, "cp1252")) == {"name": "Zürich"}


def test_an_error_keeps_its_kind_and_names_the_code_page():
    finding = Finding("reading", "a.csv: not UTF-8, and so read as Windows-1252.")
    with pytest.raises(UnitError, match=" Not UTF-8, and so"), encoding_mentioned([finding]):
        raise UnitError("a.csv", "unclear", ("curves", "value_unit"), ("m",))
