"""The figures and phases of Rawicki's tram beside ours, and what had to be identified for them.

His start holds its full current at all speeds; above 14 m/s the pull-out torque needs less, so the strategy `phases`
needs a little less energy than his law. Here the runs are planned with his, and once with ours.
"""

from functools import partial
from typing import get_args

from railjoule.core.bounds import minimise
from railjoule.core.energy import share_above
from railjoule.core.scenario import Vehicle
from railjoule.core.scenario.disturbance import Reaction
from railjoule.core.strategies import prepare_task, run_strategy, solve
from railjoule.core.units import J_PER_KWH
from railjoule.core.validation.claim import list_claims
from railjoule.core.validation.claims.rawicki import EXAMINATIONS
from railjoule.core.validation.figures.rawicki import FIGURES
from railjoule.core.validation.papers import citation, errata
from railjoule.core.validation.rawicki_identification import (
    Identification,
    driven_values,
    identify,
    machine_values,
    nameplate_values,
    value_names,
)
from railjoule.core.validation.rawicki_runs import (
    RECUPERATION_FACTORS,
    Printed,
    energy_kwh,
    energy_with_stop_kwh,
    make_planner,
    part_two_time_s,
    plan_part_two,
    plan_run,
    printed_paper,
    printed_phases,
    replan,
    solve_phases,
    tram_scenario,
)
from railjoule.core.validation.table import Comparison, Row, Table, Validation

# what the identification leaves open is said at each number that depends on it, not once in a footnote
NOT_UNIQUE = (
    "The printed numbers leave the tram open: other gear efficiencies and core losses than the assumed ones fit almost "
    "as well."
)
DIFFERENCE = "Printed is the energy with the stop, less those of part I."
BRAKING = "No single constant current meets distance and time of all printed braking phases."
NAMEPLATE = "Voltage, current, power and power factor of the nameplate are not more consistent than this."
TOGETHER = "Only the product with the inductances, the rated flux, is determined well: to {:.1f} %."
DETERMINED = "Determined to about {:.1f} %."
FLAT = "Ours needs the least energy in the same time. The optimum is flat: phases can change much, and energy little."
FLUX = ("drive.mutual_inductance_mh", "drive.rated_magnetising_current_a")
BEST_LAW = "best of all force laws"
LOCAL = "Printed is a local optimum of a smoothed power; ours drives and coasts cell by cell."
SYMBOLS = {"distance_m": ("s", "m"), "duration_s": ("t", "s"), "energy_kwh": ("En", "kWh")}


def validate_rawicki() -> Validation:
    """Return all printed numbers of Rawicki beside ours, and the identification behind ours."""
    return rawicki_comparison().validation()


def rawicki_comparison() -> Comparison:
    """Return what is to be compared of Rawicki."""
    paper = printed_paper()
    vehicle = tram_scenario(0.0).vehicle
    return Comparison(
        paper="rawicki",
        citation=citation(paper),
        # each is computed when it is asked for: the identification takes seconds, the figures do not
        tables=(
            partial(figures, paper),
            partial(planned_phases, paper),
            partial(free_current, paper),
            partial(driven_phases, vehicle, paper),
            replanned,
            partial(nameplate, vehicle, paper["nameplate"]),
            lambda: parameters(vehicle, identify(vehicle, paper)),
            partial(whole_trajectories, paper),
        ),
        errata=errata(paper),
        claims=list_claims(paper, EXAMINATIONS),
        figures=FIGURES,
    )


def figures(paper: Printed) -> Table:
    """Return the energies of Figures 1 to 4 beside ours; the run with the stop as two plans."""
    rows: list[Row] = []
    for entry in paper["figure"]:
        place, kr, printed = entry["place"], float(entry["recuperation_factor"]), entry["energy_kwh"]
        case, alone = f"{place}, kr = {kr:g}", energy_kwh(plan_run(kr))
        if "penalty_percent" not in entry:
            rows.append(Row(case, "En", "kWh", printed, alone, NOT_UNIQUE, place))
            continue
        whole, second = energy_with_stop_kwh(kr), energy_kwh(plan_part_two(kr))
        penalty = 100 * share_above(whole, alone)
        rows += [
            Row(case, "En", "kWh", printed, whole, NOT_UNIQUE, place),
            Row(case, "En of part II", "kWh", _printed_part_two(entry), second, f"{DIFFERENCE} {NOT_UNIQUE}"),
            Row(case, "penalty of the stop", "%", entry["penalty_percent"], penalty, NOT_UNIQUE, f"{place}, penalty"),
        ]
    return Table("Energies of the runs", tuple(rows), "Figs. 1 to 4")


def planned_phases(paper: Printed) -> Table:
    """Return the printed phases of part II beside those of our best run with the same distance and time."""
    rows: list[Row] = []
    for kr in RECUPERATION_FACTORS:
        part = f"part II, kr = {kr:g}"
        ours = {phase.phase: phase for phase in make_planner(kr).phases_of(plan_part_two(kr))}
        for printed in printed_phases(part):
            own = ours[printed["phase"]]
            case = f"{part}, {printed['phase']}"
            rows += [
                Row(case, "s", "m", printed["distance_m"], own.distance_m, FLAT, f"{case}, s"),
                Row(case, "t", "s", printed["duration_s"], own.duration_s, FLAT, f"{case}, t"),
                Row(case, "v at its start", "m/s", printed["start_ms"], own.start_ms, FLAT, f"{case}, v"),
            ]
    ride = f"{paper['part_ii_length_m']:g} m in {part_two_time_s():g} s"
    return Table(f"Phases of part II as planned by us, {ride}", tuple(rows), "below Figs. 3 and 4")


def replanned() -> Table:
    """Return the run with the stop as driver and computer replan it during the run; the paper prints the driver's."""
    rows = []
    for kr in RECUPERATION_FACTORS:
        for reaction in get_args(Reaction):
            run, case = replan(kr, reaction), f"kr = {kr:g}, {reaction}"
            rows += [
                Row(case, "En", "kWh", None, run.actual.energy_kwh),
                Row(case, "late", "s", None, run.delay_s),
            ]
    return Table("The run replanned on the way, only ours", tuple(rows))


def free_current(paper: Printed) -> Table:
    """Return what the run of Figures 1 and 2 needs with a starting current of its choice, and at one speed."""
    rows: list[Row] = []
    scenario = tram_scenario(0.0)
    ride = f"{scenario.line.length_m:g} m in {scenario.travel_time_s:g} s"
    for entry in paper["reference"]:
        kr = float(entry["recuperation_factor"])
        case = f"{ride}, kr = {kr:g}"
        if entry["place"] == BEST_LAW:
            # this reference is of other solvers without phases, over the same task
            rows += _best_force_law(kr, case, entry)
            continue
        # his law has one current for all starts; what a free choice of it would save shows how much that law costs
        free, steady = plan_run(kr, free_starting_current=True), plan_run(kr, coast=False)
        assert free.starting_current_a is not None
        rows += [
            Row(case, "En, free starting current", "kWh", entry["energy_kwh"], energy_kwh(free)),
            Row(case, "its starting current", "A", None, free.starting_current_a),
            Row(case, "En at constant speed, without coasting", "kWh", None, energy_kwh(steady)),
        ]
    return Table(f"Other runs over {ride}", tuple(rows), reference="independent")


def _best_force_law(kr: float, case: str, entry: Printed) -> list[Row]:
    """Return the best of all force laws beside what other solvers found, without and with free switching."""
    task = prepare_task(tram_scenario(kr))
    run = run_strategy(task, "optimal")
    # the relaxed optimum: machines that switch on and off at will, which bounds all force laws from below
    switched = minimise(task).energy_j
    assert run.lower_bound_kwh is not None
    return [
        Row(case, f"En, {BEST_LAW}, without switching", "kWh", entry["energy_kwh"], run.energy_kwh, LOCAL),
        Row(case, f"En, {BEST_LAW}, switched freely", "kWh", entry["switched_kwh"], switched / J_PER_KWH),
        Row(case, "its lower bound", "kWh", None, run.lower_bound_kwh),
    ]


def driven_phases(vehicle: Vehicle, paper: Printed) -> Table:
    """Return the 24 printed numbers of phases beside ours, each phase driven between its printed speeds."""
    ours = iter(driven_values(vehicle, paper["phase"]))
    rows = []
    for phase in paper["phase"]:
        for name in value_names(phase):
            symbol, unit = SYMBOLS[name]
            note = BRAKING if phase["phase"] == "brake" else ""
            case = f"{phase['part']}, {phase['phase']}"
            rows.append(Row(case, symbol, unit, phase[name], float(next(ours)), note, f"{case}, {symbol}"))
    return Table("Phases between their printed speeds, with the identified tram", tuple(rows), "below Figs. 3 and 4")


def nameplate(vehicle: Vehicle, plate: Printed) -> Table:
    """Return the nameplate of a motor beside ours at rated flux, frequency and speed."""
    quantities = (("U_m", "V"), ("I_m", "A"), ("P", "W"), ("cos phi", ""))
    case = f"{plate['speed_rpm']:g} r/min at {plate['frequency_hz']:g} Hz"
    printed, ours = nameplate_values(plate), machine_values(vehicle, plate)
    rows = tuple(
        Row(case, name, unit, float(f"{a:.5g}"), float(b), NAMEPLATE, f"nameplate, {name}")
        for (name, unit), a, b in zip(quantities, printed, ours, strict=True)
    )
    return Table("Nameplate of a motor, amplitudes per phase", rows, "rated data")


def parameters(vehicle: Vehicle, identification: Identification) -> Table:
    """Return the numbers of the shipped tram beside those identified again, and how well they are determined."""
    shipped = vehicle.model_dump()
    rows = []
    for key, value in zip(identification.names, identification.values, strict=True):
        *tables, last = key.split(".")
        table = shipped
        for name in tables:
            table = table[name]
        note = DETERMINED.format(identification.uncertainty_percent(key))
        if key in FLUX or key == "drive.stator_inductance_mh":
            note += " " + TOGETHER.format(identification.uncertainty_percent(*FLUX))
        # the shipped file holds the result of an earlier identification: the two must agree, which no printed number
        # could show
        rows.append(Row("assets/vehicles/tram-105n.toml", key, "", table[last], float(value), note))
    return Table("Parameters that the paper does not print, identified again", tuple(rows), reference="shipped")


def whole_trajectories(paper: Printed) -> Table:
    """Return what the strategy `phases` needs with its own start, which takes no more current than helps."""
    rows = []
    for entry, with_stop in zip(paper["figure"][:2], paper["figure"][2:], strict=True):
        kr = float(entry["recuperation_factor"])
        case, energy = f"{entry['place']}, whole trajectory", solve_phases(kr).energy_kwh
        rows.append(Row(case, "En", "kWh", entry["energy_kwh"], energy, NOT_UNIQUE, entry["place"]))
        part = tram_scenario(kr).replace(
            **{
                "line.sections": [{"length_m": paper["part_ii_length_m"]}],
                "timetable.travel_time_s": part_two_time_s(),
            }
        )
        rows.append(
            Row(
                f"part II, kr = {kr:g}, whole trajectory",
                "En",
                "kWh",
                _printed_part_two(with_stop),
                solve(part, "phases").energy_kwh,
                f"{DIFFERENCE} Its start takes less than the full current where that pulls more.",
            )
        )
    return Table("The strategy `phases`, with less than full current beyond the pull-out", tuple(rows), "Figs. 1 to 4")


def _printed_part_two(figure: Printed) -> float:
    """Return the printed energy of a run with the stop, less that of part I [kWh]."""
    kr, energies = figure["recuperation_factor"], [phase["energy_kwh"] for phase in printed_phases("part I")]
    # printed with kr = 1; braking energies are negative there and count by the share that is recuperated
    part_one = sum(energy if energy > 0 else kr * energy for energy in energies)
    return float(round(figure["energy_kwh"] - part_one, 3))
