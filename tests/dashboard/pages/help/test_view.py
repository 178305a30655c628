"""The page Help without a browser."""

import pytest

from railjoule.dashboard.pages.help.view import documentation_html


@pytest.mark.parametrize("built", [True, False])
def test_the_documentation_is_linked_once_it_is_built(built: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """An installed package has no built documentation: a link there would lead to a page that says so."""
    monkeypatch.setattr("railjoule.dashboard.pages.help.view.is_built", lambda: built)
    assert ('href="docs/"' in documentation_html()) == built
