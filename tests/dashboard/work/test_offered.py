from pathlib import Path

from railjoule.dashboard.work.offered import MOST, Offered


def written(offered: Offered, text: str) -> Path:
    path = offered.new_path(".csv")
    path.write_text(text, encoding="utf-8")
    return path


def test_a_file_is_had_once() -> None:
    offered = Offered()
    path = written(offered, "a")
    token = offered.offer(path, "../study.csv")
    assert offered.take("none") is None
    file = offered.take(token)
    assert file is not None
    assert (file.path.read_text(encoding="utf-8"), file.name) == ("a", "study.csv")
    assert offered.take(token) is None
    file.drop()
    assert not path.exists()


def test_the_oldest_goes_when_too_many_wait() -> None:
    offered = Offered()
    paths = [written(offered, str(k)) for k in range(MOST + 1)]
    tokens = [offered.offer(path, "study.csv") for path in paths]
    assert offered.take(tokens[0]) is None
    assert not paths[0].exists()
    assert offered.take(tokens[-1]) is not None
