"""The form in which a report is asked for: its sections, its author, a note."""

from typing import Any

import param

from railjoule.dashboard.editor.forms import Form
from railjoule.dashboard.limits import LONGEST_NOTE
from railjoule.dashboard.look.scripts import module
from railjoule.dashboard.report.contents import Contents
from railjoule.dashboard.report.section_names import SECTION_TITLES


class ReportForm(Form):
    """A dialog over the page; what is typed in it stays in the browser until a report is asked for."""

    sections = param.List(
        default=[[name, title] for name, title in SECTION_TITLES.items()],
        doc="Names and titles.",
    )
    longest_note = param.Integer(default=LONGEST_NOTE, doc="Characters of the note at most.")
    refusal = param.String(default="", doc="Why there is no such report.")
    open = param.Boolean(default=False, doc="Whether it is in sight.")

    _esm = module("report_form")


def contents_of(message: dict[str, Any]) -> Contents:
    """Return what a message of the form asks for.

    Raises
    ------
    ContentsError
        If there can be no such report.
    """
    sections, author, note = (message.get(name) for name in ("sections", "author", "note"))
    names = sections if isinstance(sections, list) else []
    return Contents(tuple(map(str, names)), str(author or "").strip(), str(note or "").strip())
