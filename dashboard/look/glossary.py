"""The glossary: every term and every number that the pages show, in at most 35 words each.

Beside the terms on the pages, and as a whole on the page Help. Entries of strategies stand in
`railjoule.core.strategies`, with all else that is shown of them.
"""

import re
from dataclasses import dataclass
from functools import cache

from railjoule.core import strategy
from railjoule.dashboard.look.markup import Markup, markup

# an entry opens within the page, and pushes down what stands beneath it
MOST_WORDS = 35


@dataclass(frozen=True)
class Term:
    """One entry.

    Parameters
    ----------
    name : str
        What it is looked up by.
    text : str
        What it means here.
    labels : tuple of str
        What else it is called on the pages: labels of numbers and of fields.
    """

    name: str
    text: str
    labels: tuple[str, ...] = ()

    @property
    def slug(self) -> str:
        """Its name in addresses and attributes."""
        return re.sub(r"[^a-z0-9]+", "-", self.name.lower()).strip("-")


STRATEGIES = tuple(Term(one.label, one.help, one.labels) for one in strategy.STRATEGIES.values() if one.help)
ENERGY = (
    Term(
        "Energy from the supply",
        "What the train takes from the overhead line or third rail over the run, less what "
        "it feeds back while braking. Auxiliaries such as heating are included.",
        (
            "Energy",
            "Energy of the whole line",
            "Optimum at this time",
            "Energy of a run",
            "Planned run",
        ),
    ),
    Term(
        "Energy saved per extra second",
        "Energy that arriving one second later would save. In the theory it is the "
        "multiplier of the travel time, also called the price of a second.",
        ("Extra second saves", "Price of a second", "Check", "saved per extra second, Wh"),
    ),
    Term(
        "Above the optimum",
        "By how much this run's energy exceeds the optimum in the time of the timetable, or the best known run where "
        "no optimum is proven. A late run shows its delay instead.",
        ("above optimum", "Above best known", "above"),
    ),
    Term(
        "Next best",
        "The strategy that needs least after the best one and arrives on time, and how much more that is.",
    ),
    Term(
        "Strategies on time",
        "Those that arrive within the timetable. A late one takes no part in the comparison: more time always saves "
        "energy.",
    ),
    Term(
        "Bound",
        "A lower bound: no way of driving this train over this line in this time uses less energy. It is computed "
        "separately from the run. The least energy lies between both.",
        ("bound",),
    ),
    Term(
        "Gap",
        "The distance between a run and the lower bound. With a gap of 1 %, no other run needs less by more than 1 % "
        "of the bound.",
        ("Above the bound",),
    ),
    Term(
        "Proven",
        "The run lies above its lower bound by at most the tolerance of the scenario, 0.05 % unless set otherwise, and "
        "counts as the optimum. Drive states the bound below its numbers.",
    ),
    Term(
        "Proof",
        "Prices along the line that no run can beat. For drives with idle losses, possible speeds are then divided "
        "into boxes, and those that only more expensive runs pass are dropped.",
        ("Prove further",),
    ),
    Term(
        "Price of force",
        "What a joule of work at the wheels is worth at a place, in joules from the supply. Where it is high, driving "
        "pays; where it is low, braking does; between, coasting.",
        ("costate",),
    ),
    Term(
        "Simpler advice",
        "The run with the fewest instructions to the driver (full power, hold, coast or brake) that needs at most 1 % "
        "more energy than the optimum.",
    ),
    Term(
        "Best known",
        "The run with the least energy that any strategy has found, where the optimum is not proven.",
        ("Best known run",),
    ),
    Term(
        "Recuperated energy",
        "Energy that braking feeds back to the supply, losses of the powertrain already taken off.",
        ("Recuperated", "Recuperation"),
    ),
    Term(
        "Recuperation factor",
        "Share of the braking energy, after losses of the powertrain, that the supply takes back. At "
        "zero all of it is lost in brake resistors.",
        ("Recuperation, %",),
    ),
    Term(
        "Energy per tonne and kilometre",
        "Energy from the supply divided by mass and distance: it compares runs of different trains and lines.",
        ("Per tonne and km",),
    ),
    Term(
        "Extra energy",
        "What the actual run uses more, as a share of the energy of a plan made for the actual load: the cost of "
        "wrong assumptions.",
        ("Largest in table", "above a plan for that load"),
    ),
    Term(
        "Agreement with print",
        "A computed number agrees with the printed one within 1 %, a percentage within one percentage point. Each "
        "printed number counts once, in the first table that compares it.",
        ("Numbers that agree", "Differ, with a reason", "Differ, unexplained", "Rows without a printed number"),
    ),
    Term(
        "Claim",
        "A sentence of a paper that asserts a number or a comparison; runs of railjoule support or refute it.",
        ("Claims supported",),
    ),
    Term(
        "Saving",
        "By how much less energy the first of two runs needs than the second, as a share of the second.",
        ("Coasting saves", "Right plan saves"),
    ),
)
TIME = (
    Term(
        "Travel time",
        "Time from departure to standstill at the last stop, dwells at stations included.",
        ("Travel time, s",),
    ),
    Term(
        "Change of time",
        "By how much the least energy changes if the travel time is a tenth longer or shorter.",
        ("10 % more time", "10 % less time"),
    ),
    Term("Dwell", "How long the train stands at a station; it counts as travel time.", ("Dwell, s",)),
    Term(
        "Fixed arrival",
        "An arrival that the timetable prescribes. Between two of them every second is worth the same energy.",
    ),
    Term(
        "Window of arrival",
        "The earliest and the latest arrival at a station; an empty one leaves its side free. Only the optimum keeps "
        "windows; other strategies say which they miss.",
        ("Earliest arrival, s", "Latest arrival, s"),
    ),
    Term(
        "Given timetable",
        "Arrivals that are given for the stations, shown beside the optimum. Between two of them the optimum shares "
        "the time. The optimum itself need not keep them.",
        ("Given arrival, s",),
    ),
    Term(
        "Passing point",
        "A place that the train passes at a given speed, such as a signal or a junction; without a stop.",
    ),
    Term("Late departure", "Simulated days depart late by this much on average.", ("Departure delay, mean, s",)),
    Term("Slack", "Travel time beyond the shortest possible run. It is what coasting and lower speeds are paid with."),
    Term(
        "Supplement",
        "Running-time supplement: the slack that a timetable plans for, so that delays can be made up.",
        ("Equal supplement", "Proportional supplement", "Running-time supplement", "time reserve"),
    ),
    Term(
        "Accepted delay",
        "How late the train may arrive after an event. A later arrival needs less energy.",
        ("Accepted delay, s",),
    ),
    Term(
        "Delay",
        "Arrival compared with the plan: plus is late, minus is early.",
        (
            "Arrival",
            "Arrival error",
            "Arrives",
            "late, s",
        ),
    ),
    Term(
        "Time window",
        "How far the travel time under set speeds may differ from the timetable. Few limits seldom hit "
        "the second exactly.",
        ("Time window, \u00b1 %",),
    ),
)
MEASURED = (
    Term(
        "Could save",
        "What the best run in the same time, with the same stops, needs less than the measured speeds, both by the "
        "model. Stated only where errors of speed and model do not explain it.",
    ),
    Term(
        "Measured energy",
        "What the run's own energy meter says; without one, its measured power summed over time.",
        ("Measured",),
    ),
    Term(
        "Modelled energy",
        "What the scenario's train needs by its model to drive the measured speeds.",
        ("Modelled",),
    ),
    Term(
        "Optimum in the measured time",
        "The least energy in which the modelled train covers the same stretch in the same time, with the same stops.",
        ("Optimal, same time",),
    ),
    Term(
        "Model error in power",
        "Root mean square over time of modelled less measured power, as a share of that of the measured power. Moments "
        "of switching count most.",
    ),
)
DRIVING = (
    Term(
        "Coasting",
        "Rolling without power and without brakes. Only running resistance and gradients change the speed.",
        ("Coasts", "coast", "Motors off at"),
    ),
    Term("Hold", "Keeping one speed with just as much power or braking as resistance and gradient ask for.", ("hold",)),
    Term(
        "Highest speed",
        "The largest speed of the run; beneath it the mean, distance over travel time, stops included.",
        ("top, km/h",),
    ),
    Term(
        "Replanning",
        "Computing the rest of the run again when something unexpected is noticed, with the time that is left.",
        ("Replanned run", "Replanning saves", "Replanning costs", "Replanned"),
    ),
    Term(
        "Advance notice",
        "The train knew of the event before it departed, so the whole run is planned for it. Nobody "
        "who learns of it later can do better.",
        ("With advance notice",),
    ),
    Term(
        "Driver without help",
        "Holds the speed or coasts on as planned, brakes for the event, then drives the optimal remainder.",
        ("Driver",),
    ),
    Term(
        "Cost of the events",
        "Extra energy of the driver without help, compared with the undisturbed run.",
        ("Extra energy, driver", "Energy saved, driver"),
    ),
    Term("Extra energy of set speeds", "What the set speeds cost above the best run known in the same time."),
    Term(
        "Overshoot",
        "How far beyond its stopping place the train comes to rest; minus means short of it.",
        ("Stopping error",),
    ),
    Term(
        "Best acceleration time",
        "The length of ENOC's ramp that needs the least energy for this travel time.",
        ("Acceleration time, s",),
    ),
)
TRAIN = (
    Term(
        "Tractive effort", "Force at the wheels, positive for driving and negative for electric braking.", ("Effort",)
    ),
    Term(
        "Running resistance",
        "Force of air, bearings and rails against the motion, with a constant, a linear and a "
        "quadratic part in speed. Gradients and curves are counted separately.",
    ),
    Term(
        "Load factor",
        "Passengers on board as a share of the capacity. A loaded train is heavier, so it needs more "
        "energy to start and rolls farther.",
        ("Load, % of capacity", "Actual load, % of capacity", "Load, \u00b1 %"),
    ),
    Term(
        "Storage",
        "A battery or supercapacitor on board that stores braking energy and returns it. Needed is the "
        "size at which nothing is lost.",
        ("Storage needed", "Storage, kWh"),
    ),
    Term(
        "Cause of extra energy",
        "What makes the actual run use more than the plan: load, position error, conditions, stops and other events, "
        "added one after another in this order.",
        ("Largest cause", "Actual run costs", "Actual run saves", "Against the plan"),
    ),
    Term(
        "Section",
        "A stretch of the line with one set speed. More sections come closer to the optimum.",
        ("Sections",),
    ),
    Term(
        "Braking rate",
        "Deceleration at the stop, and that of the target curve that a train follows into its stopping place.",
        ("Braking rate, m/s\u00b2", "Target curve, m/s\u00b2"),
    ),
    Term(
        "Braking curve",
        "The speed that train protection permits before a lower limit or a stop: it ends there and rises backwards "
        "with the permitted deceleration.",
        ("Permitted deceleration",),
    ),
    Term(
        "Storage power",
        "How fast the storage takes and gives energy; braking above it is lost in resistors.",
        ("Power, kW",),
    ),
    Term(
        "Storage efficiency",
        "Shares of the energy that remain after charging and after discharging.",
        ("Charging efficiency, %", "Discharging efficiency, %"),
    ),
    Term(
        "Spread of the days",
        "How far simulated days typically stray around the plan, to each side.",
        ("Resistance, \u00b1 %", "Supply voltage, \u00b1 %", "Sensor places, \u00b1 m"),
    ),
    Term(
        "Position error",
        "Where the train assumes it is, less where it is; called coordinate error in the papers. It "
        "makes every phase begin too early or too late.",
        ("Position error, m", "Position error, \u00b1 m"),
    ),
    Term(
        "Speed error",
        "How far the measured speed is from the actual one, in percent. It grows into a position error "
        "until a sensor resets the position.",
        ("Speed error, %", "Speed error, \u00b1 %"),
    ),
    Term(
        "Reset of the position",
        "A trackside sensor tells the train where it is, so that its position error starts again from zero.",
        ("D1, resets position", "D3, resets position", "D1 to D2, calibrates"),
    ),
    Term(
        "Place error",
        "How much farther on a sensor of precision braking stands than the train assumes. That of D3 shifts the stop.",
        tuple(f"{name} place error, m" for name in ("D1", "D2", "D3")),
    ),
    Term(
        "Runs on time",
        "Share of the simulated days on which the train arrives by the timetable, or at most as late as is accepted.",
        ("Accepted lateness, s",),
    ),
    Term("Median", "Half of all simulated days cost less than this.", ()),
    Term("95th percentile", "Nineteen of twenty simulated days cost less than this.", ()),
    Term("Seed", "Where the random numbers begin: the same seed gives the same simulated days again.", ("Its seed",)),
)
MOTORS = (
    Term(
        "Field-oriented control",
        "A way to control induction motors: one part of the current makes the magnetic field, "
        "the other the torque, each by its own controller.",
    ),
    Term(
        "Slip",
        "By how much the rotor turns slower than the field of the stator. It grows with torque and causes "
        "losses in the rotor.",
    ),
    Term(
        "Rotor flux",
        "The magnetic field of the rotor. Less field means less magnetising loss but more current for the same torque.",
        (),
    ),
    Term(
        "Magnetising loss",
        "Copper loss of the current that makes the magnetic field; the paper's energy leaves it out.",
    ),
    Term(
        "Energy at the motors",
        "The energy that the motors take less all that they generate in braking, even if the supply takes none back. "
        "The sum of work and losses must equal it.",
    ),
    Term("Tracking error", "The largest distance between planned and simulated position during the run."),
    Term("Peak current", "The largest amplitude of a motor's phase current during the run.", ("Current, A",)),
    Term(
        "Peak voltage",
        "The largest amplitude of a motor's phase voltage; the inverter can supply only so much.",
        ("Phase voltage, V",),
    ),
    Term(
        "Current ripple",
        "The small, fast waves of current that switching of the inverter causes.",
        ("Ripple at t, s",),
    ),
    Term(
        "Power factor",
        "Input power of a motor over what its voltage and current could carry. In a cruise on level track, less flux "
        "raises it until the torque current grows.",
        ("Cruise speed, km/h",),
    ),
    Term("Speed noise", "Random error of the measured motor speed.", ("Speed noise, rad/s",)),
    Term(
        "Bandwidth",
        "How fast the speed controller reacts: a larger value follows the plan more closely and amplifies noise.",
        ("Bandwidth, rad/s",),
    ),
    Term(
        "Assumed rotor resistance",
        "The controller's value of the rotor resistance over the true one. If it is wrong, "
        "field and torque are no longer separate.",
        ("Assumed / true resistance",),
    ),
)
STUDIES = (
    Term(
        "Sobol\u2019 indices",
        "How much of the variance of the energy an input decides over the ranges of a study: alone, and with all "
        "that it does together with others.",
        ("Decides most",),
    ),
    Term(
        "Lowest and highest",
        "The lowest and the highest energy of all runs so far, with the values of the two inputs that decide most.",
        ("Lowest", "Highest"),
    ),
    Term(
        "Feasible",
        "The share of a study\u2019s runs that reach the end in their time; the others are listed in its file with the "
        "reason.",
    ),
    Term(
        "Sampling",
        "How the runs of a study are drawn: evenly, by a Sobol\u2019 or Halton sequence that leaves no part of the "
        "ranges empty, at random, or on a grid of equal steps.",
    ),
)
GROUPS: dict[str, tuple[Term, ...]] = {
    "Strategies": STRATEGIES,
    "Energy and proof": ENERGY,
    "Measured runs": MEASURED,
    "Time": TIME,
    "Driving": DRIVING,
    "Train and line": TRAIN,
    "Motors": MOTORS,
    "Studies": STUDIES,
}
"""All terms as Help lists them."""
TERMS = tuple(term for terms in GROUPS.values() for term in terms)


@cache
def _by_label() -> dict[str, Term]:
    return {label: term for term in TERMS for label in (term.name, *term.labels)}


def term_of(label: str) -> Term | None:
    """Return the entry that explains a label or a term, if there is one."""
    return _by_label().get(label)


def texts() -> dict[str, dict[str, str]]:
    """Return name and text of each entry by its slug, as the browser shows them."""
    return {term.slug: {"name": term.name, "text": term.text} for term in TERMS}


def info(label: str) -> Markup:
    """Return the button that explains a label; nothing where the glossary does not know it."""
    term = term_of(label)
    if term is None:
        return Markup()
    return markup(
        "<button class=info data-term='{}' aria-expanded=false aria-label='What is meant: {}'></button>",
        term.slug,
        term.name,
    )
