"""The form in which a user says what the columns of a file mean."""

from collections.abc import Callable

import param

from railjoule.core.measured.columns import UNITS
from railjoule.dashboard.editor.forms import Form
from railjoule.dashboard.look.scripts import module
from railjoule.dashboard.look.theme import editor_css
from railjoule.dashboard.pages.measured_runs.columns import QUANTITY_WORDS, UNIT_WORDS, Meaning
from railjoule.dashboard.pages.measured_runs.compute import ReadRun

CSS = """
.column-form { padding: 2px 20px 10px; overflow-x: auto; }
table { width: auto; max-width: 100%; }
th[scope=row] { font-weight: 500; text-align: left; white-space: normal; overflow-wrap: anywhere; max-width: 22ch;
  border-bottom: 0; color: var(--rj-ink); }
td, th { padding: 3px 14px 3px 0; vertical-align: middle; }
td, th:not(.sample) { text-align: left; }
td.sample { text-align: right; color: var(--rj-ink2); max-width: 12ch; overflow: hidden; text-overflow: ellipsis; }
th.more { text-align: left; padding-left: 14px; }
.unused th, .unused td { color: var(--rj-ink3); }
select { width: auto; max-width: 150px; min-height: 26px; }
.doubted { background: var(--rj-over); border-color: var(--rj-overline); }
.doubt td { white-space: normal; border-top: 0; }
.doubt div { display: flex; flex-wrap: wrap; gap: 6px 12px; align-items: center; padding: 8px 12px; margin-bottom: 4px;
  border: 1px solid var(--rj-overline); border-radius: 6px; }
.doubt b { color: var(--rj-overline); }
.answer { min-height: 28px; padding: 2px 12px; border: 1px solid var(--rj-line2); border-radius: 6px; background: none;
  color: var(--rj-accent); font: inherit; font-weight: 500; cursor: pointer; }
.answer.first { background: var(--rj-accent); border-color: var(--rj-accent); color: var(--rj-surface); }
@media (max-width: 899px) { .column-form { padding: 2px 14px 10px; } .more { display: none; }
  td, th { padding-right: 8px; }
  select { max-width: 112px; } }
"""


class ColumnsForm(Form):
    """What each column means, drawn and changed in the browser.

    Parameters
    ----------
    say : callable
        Called with a column's name and what it means, as a text to be kept.
    """

    columns = param.List(default=[], doc="What each row shows.")
    quantities = param.List(default=[list(pair) for pair in QUANTITY_WORDS.items()], doc="What a column may hold.")
    units = param.Dict(
        default={quantity: [[unit, UNIT_WORDS.get(unit, unit)] for unit in units] for quantity, units in UNITS.items()},
        doc="The units of each.",
    )
    version = param.Integer(default=0, doc="Counts what was sent: the browser redraws at each.")

    _esm = module("columns_form")

    def __init__(self, say: Callable[[str, str], None]) -> None:
        super().__init__(
            lambda message: say(str(message.get("header")), str(message.get("text"))), stylesheets=[editor_css(), CSS]
        )

    def show(self, read: ReadRun) -> None:
        """Show the columns of a file."""
        doubts = {doubt.header: doubt for doubt in read.doubts}
        rows = []
        for header, meaning in read.meanings.items():
            doubt = doubts.get(header)
            asked = (
                None
                if doubt is None
                else {
                    "sentence": doubt.sentence,
                    "choices": [[one.text, _answer_words(one, meaning)] for one in doubt.choices],
                }
            )
            rows.append(
                {
                    "header": header,
                    "quantity": meaning.quantity,
                    "unit": meaning.unit,
                    "samples": read.file.samples(header),
                    "doubt": asked,
                }
            )
        if rows != self.columns:
            self.param.update(columns=rows, version=self.version + 1)


def _answer_words(choice: Meaning, meaning: Meaning) -> str:
    return f"{'Keep' if choice.unit == meaning.unit else 'Use'} {choice.unit}"
