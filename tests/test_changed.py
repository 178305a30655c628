"""The test files that a change can reach, in the files as they are."""

import subprocess
from pathlib import Path

import changed
import pytest
from changed import SMOKE, changed_files, module_paths, reached_tests

CASES = {
    # by an import of the product, of a helper of the tests, or by the name of a page, a script or a folder
    "core/simulation/following.py": {SMOKE, "tests/core/simulation/test_following.py"},
    "dashboard/pages/motor/page.py": {SMOKE, "tests/browser/test_motor.py", "tests/dashboard/pages/motor/test_view.py"},
    "dashboard/command/sweeps.py": {SMOKE, "tests/dashboard/test_one_value.py"},
    "tests/browser/user.py": {SMOKE, "tests/browser/test_motor.py"},
    "tests/browser/conftest.py": {SMOKE, "tests/browser/test_motor.py"},
    "assets/scripts/navigation.js": {SMOKE, "tests/browser/test_navigation.py", "tests/browser/test_scripts.py"},
    "assets/scenarios/ftorek-300s.toml": {"tests/core/check/test_check.py"},
    "tests/browser/test_motor.py": {"tests/browser/test_motor.py"},
    "README.md": {"tests/test_readme.py"},
}
UNREACHED = "tests/core/imports/test_numbers.py"
"""It reads numbers of tables: none of the changes reaches it."""


@pytest.mark.parametrize("path", CASES)
def test_a_change_reaches_its_tests_and_not_all(path: str) -> None:
    found = set(reached_tests([path]))
    assert found >= CASES[path]
    assert UNREACHED not in found
    assert found <= set(module_paths().values())


def test_a_package_that_hands_on_names_separates_its_modules() -> None:
    # `from railjoule.core import load_scenario` needs nothing of the check of runs
    assert "tests/core/scenario/test_sections_csv.py" not in reached_tests(["core/check/energy_balance.py"])
    assert "tests/core/scenario/test_sections_csv.py" in reached_tests(["core/scenario/document.py"])


def test_commits_the_working_tree_and_new_files_are_changes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def git(*words: str) -> None:
        who = ("-c", "user.name=a", "-c", "user.email=a@b")
        subprocess.run(("git", *who, *words), cwd=tmp_path, check=True, capture_output=True)

    git("init", "--initial-branch", "main")
    for name in ("committed", "edited", "same"):
        (tmp_path / name).touch()
    git("add", ".")
    git("commit", "--message", "first")
    git("switch", "--create", "branch")
    (tmp_path / "committed").write_text("1")
    git("commit", "--all", "--message", "second")
    (tmp_path / "edited").write_text("1")
    (tmp_path / "new").touch()
    monkeypatch.setattr(changed, "ROOT", tmp_path)
    assert changed_files() == ["committed", "edited", "new"]


def test_without_the_branch_main_a_sentence_says_so(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(changed, "ROOT", tmp_path)
    with pytest.raises(SystemExit, match="compares with the branch main, which this copy of railjoule lacks"):
        changed_files()
