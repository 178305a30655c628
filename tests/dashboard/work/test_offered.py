from pathlib import Path

from railjoule.dashboard.work.offered import MOST, Offered


def written(offered: Offered, text: str) -> Path:
    path = offered.new_path(".csv")
    path.write_text(text, encoding="utf-8")
    return path


def test_a_file_is_had_once() -> None:
    offered = Offered()
    path = written(offered, "a")
    token = offered.offer(path, "study.csv")
    file = offered.take(token)
    assert file is not None
    assert (file.path.read_text(encoding="utf-8"), file.name) == ("a", "study.csv")
    assert offered.take(token) is None
    file.drop()
    assert not path.exists()
    assert not file.path.exists()


def test_the_oldest_goes_when_too_many_wait() -> None:
    offered = Offered()
    paths = [written(offered, str(k)) for k in range(MOST + 1)]
    tokens = [offered.offer(path, "study.csv") for path in paths]
    assert offered.take(tokens[0]) is None
    assert not list(paths[0].parents[1].glob(f"*/{tokens[0]}"))
    assert offered.take(tokens[-1]) is not None


def test_another_process_hands_it_over_where_the_folder_is_shared(tmp_path: Path) -> None:
    writes, asked, alone = Offered(), Offered(), Offered()
    for one in (writes, asked):
        one.share(tmp_path)
    token = writes.offer(written(writes, "a"), "study.csv")
    assert alone.take(token) is None
    file = asked.take(token)
    assert file is not None
    assert file.path.read_text(encoding="utf-8") == "a"
    assert writes.take(token) is None
    # that it went elsewhere does not matter to who has written it
    for _ in range(MOST + 1):
        last = writes.offer(written(writes, "b"), "study.csv")
    assert asked.take(last) is not None


def test_no_token_leads_out_of_the_folder(tmp_path: Path) -> None:
    offered = Offered()
    offered.share(tmp_path / "own")
    (tmp_path / "own").mkdir()
    (tmp_path / "secret").mkdir()
    (tmp_path / "secret" / "file").touch()
    for token in ("../../secret", "..", "", "none"):
        assert offered.take(token) is None, token
    assert (tmp_path / "secret" / "file").exists()
