import resource
import signal
import stat
from collections.abc import Iterator
from pathlib import Path

import pytest

from railjoule.core.written import require_writable, write_text, written


@pytest.fixture
def full_disk() -> Iterator[None]:
    """Let no file grow beyond 10 kB: the system refuses each further byte, as it does on a full disk."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    # without a handler the signal ends the process before the error is raised
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, before)
    signal.signal(signal.SIGXFSZ, handler)


def test_a_file_takes_the_place_of_the_old_one_and_keeps_its_rights(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text("old")
    path.chmod(0o640)
    write_text(path, "new")
    assert path.read_text() == "new"
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    assert list(tmp_path.iterdir()) == [path]


def test_a_new_file_has_the_rights_that_others_have(tmp_path: Path) -> None:
    plain, path = tmp_path / "plain", tmp_path / "run.csv"
    plain.write_text("")
    write_text(path, "new")
    assert path.stat().st_mode == plain.stat().st_mode


def test_the_old_file_outlasts_a_full_disk_and_nothing_is_left(tmp_path: Path, full_disk: None) -> None:
    path = tmp_path / "report.html"
    path.write_text("old")
    with pytest.raises(OSError, match="File too large"):
        write_text(path, "x" * 20_000)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_so_it_does_an_error_of_whoever_writes(tmp_path: Path) -> None:
    def fail() -> None:
        with written(tmp_path / "run.csv") as place:
            place.write_text("half")
            raise ValueError("no table")

    with pytest.raises(ValueError, match="no table"):
        fail()
    assert list(tmp_path.iterdir()) == []


def test_the_place_has_the_files_ending(tmp_path: Path) -> None:
    with written(tmp_path / ("n" * 240 + ".parquet")) as place:
        assert place.suffix == ".parquet"
        place.write_text("")


def test_a_link_goes_on_leading_to_its_file(tmp_path: Path) -> None:
    (tmp_path / "real.csv").write_text("old")
    link = tmp_path / "link.csv"
    link.symlink_to("real.csv")
    write_text(link, "new")
    assert link.is_symlink()
    assert (tmp_path / "real.csv").read_text() == "new"


def test_a_folder_and_a_missing_folder_are_errors_of_the_system(tmp_path: Path) -> None:
    with pytest.raises(IsADirectoryError):
        write_text(tmp_path, "new")
    with pytest.raises(FileNotFoundError):
        write_text(tmp_path / "missing" / "run.csv", "new")


def test_what_cannot_be_written_is_known_before(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text("old")
    require_writable(path)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]
    with pytest.raises(FileNotFoundError):
        require_writable(tmp_path / "missing" / "run.csv")
