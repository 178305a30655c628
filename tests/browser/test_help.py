"""The explanations of terms and the page Help, as a user reads them."""

from playwright.sync_api import Locator, expect

from browser.findings import assert_nothing_grave
from browser.user import User, open_page
from railjoule.dashboard.look.glossary import TERMS, find_term
from railjoule.dashboard.page_list import PAGES


def sign(user: User, label: str) -> Locator:
    """Return the sign beside a term."""
    term = find_term(label)
    assert term is not None
    return user.page.locator(f'.info[data-term="{term.slug}"]:visible').first


def test_a_press_or_a_resting_mouse_shows_an_explanation(user: User) -> None:
    shown = user.page.get_by_role("note")
    for label, text in (("ENOC", "Energy near-optimal control"), ("Load, % of capacity", "Passengers on board")):
        sign(user, label).click()
        expect(shown).to_have_count(1)
        expect(shown).to_contain_text(text)
        expect(shown).to_be_in_viewport(ratio=1)
    user.page.keyboard.press("Escape")
    expect(shown).to_have_count(0)
    expect(sign(user, "Load, % of capacity")).to_be_focused()
    user.page.keyboard.press("Enter")
    expect(shown).to_contain_text("Passengers on board")
    user.page.mouse.click(700, 500)
    expect(shown).to_have_count(0)
    sign(user, "EOC").hover()
    expect(shown).to_contain_text("Energy-optimal control")
    user.page.mouse.move(700, 500)
    expect(shown).to_have_count(0)


def test_help_lists_everything_and_is_opened_at_a_term(user: User) -> None:
    open_page(user, "Drive")
    sign(user, "Extra second saves").click()
    user.page.get_by_role("button", name="All terms in Help").click()
    expect(user.question("Help")).to_be_visible()
    entry = user.page.locator("#term-energy-saved-per-extra-second")
    expect(entry).to_be_in_viewport()
    expect(entry).to_be_focused()
    expect(user.page.locator("[id^=term-]")).to_have_count(len(TERMS))
    for name in PAGES:
        expect(user.page.locator(f"[data-open='{name}']").first).to_be_attached()
    assert_nothing_grave(user)
    user.page.locator("[data-open=Compare]").click()
    expect(user.question("Compare")).to_be_visible()
