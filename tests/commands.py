"""What a command prints, for tests that type it."""

from railjoule.dashboard.command.cli import BAD_INPUT, OK, main


def answer(capsys, *words):
    """Run a command that must succeed; return what it printed."""
    status = main(words)
    captured = capsys.readouterr()
    assert (status, captured.err) == (OK, ""), captured.err
    return captured.out


def complaint(capsys, *words):
    """Run a command that must fail; return its one sentence."""
    status = main(words)
    captured = capsys.readouterr()
    assert status == BAD_INPUT
    assert captured.out == ""
    assert captured.err.startswith("railjoule: ")
    assert captured.err.endswith((".\n", "?\n"))
    assert captured.err.count("\n") == 1
    return captured.err.removeprefix("railjoule: ").rstrip("\n")
