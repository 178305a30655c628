"""The runs of a study that are chosen, as a table, and the file that the browser fetches."""

from collections.abc import Mapping
from typing import Any

import param
from panel.custom import JSComponent

from railjoule.dashboard.editor.forms import Form
from railjoule.dashboard.look import words
from railjoule.dashboard.look.scripts import module
from railjoule.dashboard.look.theme import editor_css, study_css
from railjoule.dashboard.pages.study.columns import Column, columns_of
from railjoule.dashboard.pages.study.compute import ENERGY, RESULTS, Bounds, Look
from railjoule.dashboard.pages.study.model import ROWS_AT_ONCE, Saved, StudyModel


class StudyRows(Form):
    """The table."""

    title = param.String(default="", doc="How many runs are chosen.")
    note = param.String(default="", doc="Between which values.")
    head = param.List(default=[], doc="The columns after the number of the run.")
    rows = param.List(default=[], doc="The number of each row, as it reads, and its cells.")
    more = param.String(default="", doc="The button that lists more of them; empty where there are none.")
    is_chosen = param.Boolean(default=False, doc="Whether a choice can be cleared.")

    _esm = module("study_rows")

    def __init__(self, model: StudyModel) -> None:
        super().__init__(self._take, stylesheets=[editor_css(), study_css()])
        self.model = model

    def show(self) -> None:
        """Show what was looked at last."""
        model, look = self.model, self.model.look
        if look is None or model.study is None:
            return
        columns = columns_of(model.study)
        shown = [k for k, name in enumerate(columns) if name not in RESULTS or name == ENERGY]
        told = list(columns.values())
        left = look.chosen - len(look.listed)
        self.param.update(
            title=f"{'Chosen' if look.choice else 'All'}: {words.number(look.chosen, 0)} runs",
            note=f"{bounds_words(columns, look.choice)} \u00b7 sorted by energy".removeprefix(" \u00b7 "),
            head=[_head(told[k]) for k in shown],
            rows=[
                {
                    "row": run.row,
                    "number": words.number(run.row, 0),
                    "cells": [told[k].show(run.values[k]) for k in shown],
                }
                for run in look.listed
            ],
            more=f"Next {min(left, ROWS_AT_ONCE)}" if left else "",
            is_chosen=bool(look.choice),
        )

    def _take(self, message: dict[str, Any]) -> None:
        what, row = message.get("what"), message.get("row")
        if what == "open" and type(row) is int:
            self.model.wanted_run = row
        elif what == "clear":
            self.model.param.update(choice={}, shown=ROWS_AT_ONCE)
        elif what == "more" and self.model.look is not None:
            self.model.shown = min(self.model.shown, len(self.model.look.listed)) + ROWS_AT_ONCE


def _head(column: Column) -> str:
    return f"{column.quantity}, {column.unit}".rstrip(", ")


def bounds_words(columns: Mapping[str, Column], bounds: Bounds) -> str:
    """Return between which values runs are chosen."""
    return ", ".join(
        f"{columns[name].within_sentence} {columns[name].show(low)} to {columns[name].told(high)}"
        for name, (low, high) in bounds.items()
        if name in columns
    )


def lowest_words(columns: Mapping[str, Column], values: tuple[float, ...], ranked: tuple[str, ...]) -> str:
    """Return the values of the fields that decide most in a run."""
    names = list(columns)
    return ", ".join(
        columns[name].told(values[names.index(name)])
        if columns[name].unit
        else f"{columns[name].within_sentence} {columns[name].show(values[names.index(name)])}"
        for name in ranked[:2]
    )


def ranked_fields(look: Look, columns: Mapping[str, Column]) -> tuple[str, ...]:
    """Return the fields, those that decide most first where that is known."""
    fields = tuple(name for name in columns if name not in RESULTS)
    return fields if look.shares is None else look.shares.fields


class StudyFiles(JSComponent):
    """Lets the browser fetch a file."""

    _esm = module("study_files")

    def fetch(self, saved: Saved) -> None:
        """Fetch a file."""
        self._send_msg({"place": saved.place, "name": saved.name})
