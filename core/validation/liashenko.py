"""The tables and figures of Liashenko, Yatsko 2025 beside ours."""

from functools import partial
from typing import Any

from railjoule.core.scenario import load_scenario
from railjoule.core.simulate.following import simulate_following
from railjoule.core.studies.sensitivity_table import sensitivity
from railjoule.core.validation.papers import citation, errata, printed_numbers
from railjoule.core.validation.table import Comparison, Row, Table, Validation

CONTROLLER = (
    "Ours is over the plan for the actual load, as the printed load 0 is never cheaper. The paper tells "
    "neither its controller nor the vehicle's effort and resistance, which are assumed here; nothing is tuned to it."
)
LOAD_EFFECT = "None of the controllers tried reproduces the paper's growth with the load."
# from this load on the printed values grow as none of our controllers does, and the note says so
HEAVY = 0.75

Printed = dict[str, Any]


def validate_liashenko() -> Validation:
    """Return Tables 4 to 7 of Liashenko, Yatsko 2025 and the examples of Figures 3 to 6 beside ours."""
    return liashenko_comparison().validation()


def liashenko_comparison() -> Comparison:
    """Return what is to be compared of Liashenko, Yatsko 2025."""
    paper = printed_numbers("liashenko-2025")
    return Comparison(
        paper="liashenko",
        citation=citation(paper),
        tables=(
            *(partial(overconsumption, entry, paper) for entry in paper["table"]),
            # lazily, as all tables here: each is shown as soon as it is computed
            lambda: Table("Examples of followed plans; no numbers are printed", tuple(examples(paper["figure"]))),
        ),
        errata=errata(paper),
    )


def overconsumption(entry: Printed, paper: Printed) -> Table:
    """Return one table of (12) beside ours, both directions together."""
    # the grid of the paper and not that of the study, which may change
    loads, errors = paper["load_factors"], paper["coordinate_errors_m"]
    ours = sensitivity(load_scenario(entry["scenario"]), loads, [float(error) for error in errors])
    # over the plan for the real load, not over that for the assumed one: the printed values at load 0 are never
    # negative
    percent = 100 * ours.over_replanned
    rows = [
        Row(
            case := f"{error:+g} m, load {load:g}",
            "overconsumption",
            "%",
            entry["overconsumption_percent"][m][k],
            float(percent[k, m]),
            "" if error == 0 and load == 0.5 else LOAD_EFFECT if load >= HEAVY else CONTROLLER,
            f"{entry['place']}, {case}",
        )
        for m, error in enumerate(errors)
        for k, load in enumerate(loads)
    ]
    title = load_scenario(entry["scenario"]).title
    return Table(f"{title}, 35 km/h, followed with wrong load and position", tuple(rows), entry["place"])


def examples(figures: list[Printed]) -> list[Row]:
    """Return what becomes of the plans of Figures 3 to 6."""
    rows = []
    for figure in figures:
        result = simulate_following(load_scenario(figure["scenario"]))
        rows += [
            Row(figure["place"], "planned energy", "kWh", None, result.planned.energy_kwh),
            Row(figure["place"], "overconsumption", "%", None, 100 * result.overconsumption),
            Row(figure["place"], "delay", "s", None, result.delay_s),
            Row(figure["place"], "stopping error", "m", None, result.stop_error_m),
        ]
    return rows
