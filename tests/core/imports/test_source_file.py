import re

import pytest

from railjoule.core.errors import ScenarioError
from railjoule.core.imports import SourceFile
from railjoule.core.imports.source_file import MAX_BYTES, read_json, read_text


def test_a_file_is_read_by_its_path(tmp_path):
    (tmp_path / "a.csv").write_bytes(b"from")
    assert SourceFile.read(tmp_path / "a.csv") == SourceFile("a.csv", b"from")


def test_a_missing_file_is_told(tmp_path):
    with pytest.raises(ScenarioError, match=r"there is no such file\.$"):
        SourceFile.read(tmp_path / "a.csv")


def test_a_device_without_end_is_not_read_to_its_end():
    with pytest.raises(ScenarioError, match=r"^zero: larger than the 50 MB permitted\.$"):
        SourceFile.read("/dev/zero")


def test_large_content_is_refused_however_it_came():
    with pytest.raises(ScenarioError, match=r"^a.csv: larger than the 50 MB permitted\.$"):
        read_text(SourceFile("a.csv", b" " * (MAX_BYTES + 1)))


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        ("{", "a.json: not JSON: Expecting property name enclosed in double quotes in line 1."),
        ("[1]", "a.json: must be a JSON object, {...}."),
        ('{"mass": NaN}', "a.json: NaN is not a number that can be used."),
        ('{"mass": -Infinity}', "a.json: -Infinity is not a number that can be used."),
        (f'{{"mass": {"9" * 5000}}}', "a.json: a number in it has too many digits."),
        ("[" * 200_000, "a.json: its lists or tables are nested too deeply."),
    ],
)
def test_what_is_no_json_is_refused_in_one_sentence(content, sentence):
    with pytest.raises(ScenarioError, match=f"^{re.escape(sentence)}$"):
        read_json(SourceFile("a.json", content.encode()))
