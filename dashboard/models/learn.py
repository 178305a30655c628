"""The lessons of Learn: their texts, where their sliders stand, and what they show."""

from dataclasses import dataclass
from typing import Any

import param

from railjoule.core import RailjouleError
from railjoule.dashboard.models.numbers import TypedParameters


@dataclass(frozen=True)
class Lesson:
    """A lesson in words.

    Parameters
    ----------
    name, title : str
    text : str
        What there is to understand, at most 150 words.
    question, answer : str
        What to try with the slider, and what comes out.
    label, unit : str
        Of the slider, the unit included in the label.
    ends : tuple of float
        Of the slider.
    first : float
        Where it stands at first.
    step : float
    """

    name: str
    title: str
    text: str
    question: str
    answer: str
    label: str
    unit: str
    ends: tuple[float, float]
    first: float
    step: float = 1.0


LESSONS = (
    Lesson(
        "coasting",
        "Why coasting saves",
        "Steel wheels on steel rails lose little: with its motors off this metro train loses about one km/h in ten "
        "seconds. What the brakes take at the station is another matter. It is all the motion that is left, and it "
        "grows with the square of the speed at which braking begins. So the cheapest run goes a little faster at "
        "first, switches the motors off early, rolls, and brakes from a lower speed. The dashed run takes exactly the "
        "same time: it holds one speed all the way and brakes from it. Both start and brake with full effort, and "
        "nothing is given back to the line. The level line is 1500 m long, so there is not even time to hold a speed "
        "between driving and rolling.",
        "Give the train more time. Does coasting save a larger or a smaller share?",
        "A larger one: 9.8 % at 95 s, 15.2 % at 160 s. A slower train rolls farther on the motion that it has, so a "
        "larger part of it carries the train on before the brakes take the rest.",
        "Travel time, s",
        "s",
        (95.0, 160.0),
        115.0,
    ),
    Lesson(
        "multiplier",
        "What the multiplier means",
        "The timetable is a condition, and every condition has a price. Give the train one more second, and the least "
        "energy falls by the multiplier: the slope of the curve of energy over time. One number for the whole run, "
        "and it decides everything. On level track it tells the speed to hold, the speed to which to coast, and so the "
        "whole run: that is the phase plane. To the right is speed, upward what a joule of motion is worth in joules "
        "at the line. Above the upper line a joule is worth more than it costs: full power. Below the lower line it "
        "is worth less than what braking gives back, here nothing: brake. In between neither driving nor braking "
        "pays: coast. The run starts at the top left and falls through all three.",
        "Take 30 s off, then 10 s more. How does the price of a second grow?",
        "At 200 s a second is worth 152 Wh, at 170 s 293 Wh, at 160 s 505 Wh. The last seconds are the dear ones: a "
        "little slack in the timetable is the cheapest measure of all.",
        "Travel time, s",
        "s",
        (158.0, 270.0),
        200.0,
    ),
    Lesson(
        "recuperation",
        "When to recuperate instead of coast",
        "A train that gives energy back throws less away when it brakes. Is it still right to coast? Follow one joule "
        "of motion: to get it, the drive took 1.18 joules from the line. Braking at once gives back at most 0.85. "
        "Rolling spends it on the way, which has to be run anyhow. So coasting stays right as long as giving "
        "back loses anything, only less of it: the better the drive recuperates, the lower the speed that is held, "
        "the later the motors are switched off, the higher the speed at which braking begins. In the phase plane the "
        "lower line rises toward the upper one, and the band of coasting narrows. It would close only for a drive and "
        "a line without losses. The dashed run gives nothing back.",
        "Raise recuperation from 0 to 100 %. Where does coasting begin, and how much is saved?",
        "At 0 % the motors go off after 2.6 of 6 km, at 100 % after 3.9 km, and 16.6 % of the energy are saved. Still "
        "2 km are rolled: two conversions at 85 % cost more than the way does.",
        "Recuperation, %",
        "%",
        (0.0, 100.0),
        70.0,
    ),
    Lesson(
        "gradient",
        "Why a gradient is worth knowing",
        "Many metros put their stations on humps: down after the start, up before the stop. The hump stores motion as "
        "height and gives it back for nothing. But only a plan that knows it leaves the work to it. The blue run "
        "knows the line: it switches off early, lets the train roll down and brakes with the hill. The dashed one was "
        "planned for level track and is followed just the same, speed for speed, over the hump: it brakes downhill "
        "and drives uphill, in the same time. Nothing is given back here. Height itself costs nothing: what goes up "
        "comes down. What costs is to brake on the one side what has to be driven on the other.",
        "From which gradient on does the ignorant plan need twice the energy of the knowing one?",
        "From about 24 per mille. At 20 per mille the knowing run saves 45 %, at 30 per mille 57 %, although both "
        "arrive at the same second.",
        "Gradient of the hump, \u2030",
        "\u2030",
        (0.0, 30.0),
        15.0,
    ),
    Lesson(
        "load",
        "What a wrong load costs",
        "The plan is for a train that is 30 % full. Another number of passengers gets on. The controller follows the "
        "planned speeds as well as it can: a lighter train rolls out sooner and must drive where the plan rolls; a "
        "heavier one does not reach the planned speed in time, comes later, and brakes all the same. Beside it "
        "stands the plan for the load that is really there, in the time that the driven run took, so that only the "
        "plan differs. The speeds look almost alike, and so do the energies: on this line the wrong load costs "
        "about three percent and two seconds, little beside what the passengers themselves weigh. On lines with "
        "steep gradients it can be more: see Robustness.",
        "Which is dearer, an empty train or a full one, beside a plan for the right load?",
        "They cost alike: the empty one needs 3.3 % more than it had to and is punctual, the full one 3.5 % more for "
        "a run that arrives 2.2 s late.",
        "Real load, % of capacity",
        "%",
        (0.0, 100.0),
        100.0,
    ),
)
"""In the order in which they are read."""


class LearnModel(TypedParameters):
    """Where the sliders stand, and what the lessons show."""

    kept = tuple(lesson.name for lesson in LESSONS)
    passing = ("shown",)

    coasting = param.Number(default=115.0, doc="Travel time, s")
    multiplier = param.Number(default=200.0, doc="Travel time, s")
    recuperation = param.Number(default=70.0, doc="Recuperation, %")
    gradient = param.Number(default=15.0, doc="Gradient of the hump, per mille")
    load = param.Number(default=100.0, doc="Real load, % of capacity")
    shown = param.Dict(default={}, doc="What each lesson shows.")
    failure = param.ClassSelector(
        class_=RailjouleError, default=None, allow_None=True, doc="Why a lesson could not be computed."
    )

    def __init__(self, **params: Any) -> None:
        for lesson in LESSONS:
            self.param[lesson.name].bounds = lesson.ends
        super().__init__(**params)
