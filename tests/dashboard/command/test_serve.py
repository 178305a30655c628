import runpy
import sys
import types

import pytest
from commands import answer, complaint

from railjoule.dashboard.command import cli, commands
from railjoule.dashboard.command.cli import OK, main
from railjoule.dashboard.server.options import ServerOptions


@pytest.fixture
def app(monkeypatch):
    fake = types.ModuleType("railjoule.dashboard.app")
    fake.calls = []
    fake.serve = lambda options, folder: fake.calls.append((options, folder))
    monkeypatch.setitem(sys.modules, fake.__name__, fake)
    monkeypatch.setattr(fake.__name__, fake, raising=False)
    return fake


def test_serve_passes_address_and_port(capsys, app):
    answer(capsys, "serve")
    answer(capsys, "serve", "--port", "8080", "--address", "0.0.0.0")
    words = ("--origin", "a.example", "b.example:80", "--prefix", "/tools/rail/", "--sessions", "60")
    answer(capsys, "serve", *words)
    assert [options for options, _ in app.calls] == [
        ServerOptions("127.0.0.1", 5006),
        ServerOptions("0.0.0.0", 8080),
        ServerOptions(origins=("a.example", "b.example:80"), prefix="/tools/rail", sessions=60),
    ]


def test_a_user_without_a_home_has_no_folder(app, monkeypatch):
    def homeless():
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(commands, "default_folder", homeless)
    assert main(["serve"]) == OK
    assert app.calls[0][1] is None


@pytest.mark.parametrize(
    ("words", "served"),
    [
        ((), True),
        (("--address", "localhost"), True),
        (("--address", "::1"), True),
        (("--address", "0.0.0.0"), False),
        (("--address", "example.org"), False),
        (("--origin", "railways.example"), False),
        (("--address", "0.0.0.0", "--folder", "{}"), True),
    ],
)
def test_others_save_in_no_folder_unless_one_is_named(app, tmp_path, words, served):
    assert main(["serve", *(word.format(tmp_path) for word in words)]) == OK
    assert (app.calls[0][1] is not None) == served


def test_a_port_in_use_is_one_sentence(capsys, app):
    def serve(*_):
        raise OSError(98, "Address already in use")

    app.serve = serve
    assert complaint(capsys, "serve") == "cannot serve at 127.0.0.1, port 5006: Address already in use."


def test_a_missing_package_of_the_dashboard_is_named(capsys, monkeypatch):
    monkeypatch.delattr("railjoule.dashboard.app", raising=False)
    monkeypatch.delitem(sys.modules, "railjoule.dashboard.app", raising=False)
    monkeypatch.setitem(sys.modules, "panel", None)
    assert complaint(capsys, "serve") == (
        "the dashboard needs panel, which is not installed: pip install 'railjoule[page]'."
    )


@pytest.mark.parametrize(("words", "called"), [([], ["serve"]), (["validate", "ftorek"], ["validate", "ftorek"])])
def test_the_module_without_a_command_serves(monkeypatch, words, called):
    calls = []
    monkeypatch.setattr(cli, "main", lambda arguments: calls.append(arguments) or 0)
    monkeypatch.setattr(sys, "argv", ["railjoule", *words])
    with pytest.raises(SystemExit):
        runpy.run_module("railjoule.dashboard", run_name="__main__")
    assert calls == [called]


def test_serve_says_what_it_exposes(capsys):
    assert main(["serve", "--help"]) == 0
    told = " ".join(capsys.readouterr().out.split())
    for words in ("There is no login", "/health and /ready", "No file of this machine can be read there"):
        assert words in told
