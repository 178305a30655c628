import subprocess
from pathlib import Path

import pytest
import xarray

from railjoule.core import load_scenario, solve
from railjoule.core.citation import package_version
from railjoule.dashboard import provenance
from railjoule.dashboard.command.files import write_labelled_table
from railjoule.dashboard.state.recipes import about_numbers
from railjoule.dashboard.workbench import Workbench


def git(folder: Path, *words: str) -> str:
    who = ["-c", "user.name=A", "-c", "user.email=a@b.c"]
    return subprocess.run(["git", "-C", str(folder), *who, *words], check=True, capture_output=True, text=True).stdout


def test_a_checkout_has_its_commit_and_marks_changes(tmp_path: Path) -> None:
    assert provenance._checkout_commit(tmp_path) == ""
    git(tmp_path, "init", "-q")
    (tmp_path / "file").write_text("one", encoding="utf-8")
    git(tmp_path, "add", "file")
    git(tmp_path, "commit", "-qm", "One")
    head = git(tmp_path, "rev-parse", "--short=12", "HEAD").strip()
    assert provenance._checkout_commit(tmp_path) == head
    (tmp_path / "file").write_text("two", encoding="utf-8")
    assert provenance._checkout_commit(tmp_path) == f"{head}-dirty"
    # a folder within somebody else's repository
    (tmp_path / "within").mkdir()
    assert provenance._checkout_commit(tmp_path / "within") == ""


def test_an_unknown_commit_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(provenance, "commit", lambda: "")
    assert [*provenance.versions()][:2] == ["railjoule", "numpy"]
    monkeypatch.setattr(provenance, "commit", lambda: "abc")
    assert provenance.versions()["commit"] == "abc"


def test_labelled_tables_have_their_origin(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.argv", ["railjoule", "study", "sensitivity", "a b.toml"])
    write_labelled_table(xarray.Dataset({"one": ("x", [1.0])}, attrs={"own": "kept"}), tmp_path / "x.nc")
    with xarray.open_dataset(tmp_path / "x.nc", engine="scipy") as table:
        assert table.attrs["railjoule_version"] == package_version()
        assert table.attrs["railjoule_command"] == "railjoule study sensitivity 'a b.toml'"
        assert "@software{railjoule" in table.attrs["railjoule_citation"]
        assert table.attrs["own"] == "kept"


def test_numbers_have_versions_command_and_citation() -> None:
    state = Workbench()
    state.scenario.choose("ftorek-300s")
    state.chosen = "enoc"
    state.page = "Drive"
    text = about_numbers(state)
    assert text.startswith(f"railjoule {package_version()}\n")
    assert "railjoule solve ftorek-300s" in text
    assert solve(load_scenario("ftorek-300s"), "enoc").cite().strip() in text
