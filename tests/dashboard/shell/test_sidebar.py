"""The sidebar without a browser."""

from railjoule.dashboard.browser.browser import Browser
from railjoule.dashboard.keep.keeping import Keeping
from railjoule.dashboard.shell.sidebar import Sidebar
from railjoule.dashboard.state.workbench import Workbench


def test_set_speeds_open_from_the_list_of_strategies() -> None:
    state = Workbench(page="Drive")
    browser = Browser()
    sidebar = Sidebar(state, browser, Keeping(state, browser))
    link = sidebar.strategy_part[-1]
    assert link.label == "Adjust set speeds"
    link.clicks += 1
    assert state.page == "Set speeds"
    # that page has no list of strategies
    assert not sidebar.strategy_part.visible
