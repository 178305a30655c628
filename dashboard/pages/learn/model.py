"""The lessons of Learn: their texts, where their sliders stand, and what they show."""

from dataclasses import dataclass

import param

from railjoule.dashboard.pages.learn.by_hand import TryResult
from railjoule.dashboard.pages.learn.compute import FIRST_VALUES
from railjoule.dashboard.pages.learn.drawing import DrawingResult
from railjoule.dashboard.pages.learn.guesses import GUESSES
from railjoule.dashboard.pages.learn.slack import SlackResult
from railjoule.dashboard.state.numbers import TypedNumber, TypedParameters
from railjoule.dashboard.state.page_model import PageModel, result


@dataclass(frozen=True)
class Lesson:
    """A lesson in words.

    Parameters
    ----------
    name, title : str
    text : str
        What the lesson explains, at most 150 words.
    question, answer : str
        What to try with the slider, and the result.
    number : TypedNumber
        What the slider moves.
    """

    name: str
    title: str
    text: str
    question: str
    answer: str
    number: TypedNumber

    @property
    def ends(self) -> tuple[float, float]:
        """Of the slider."""
        first, last = self.number.bounds
        return float(first), float(last)


def _slider(label: str, unit: str, ends: tuple[float, float], first: float) -> TypedNumber:
    """Return the number of a lesson, which its slider shows as far as it goes."""
    return TypedNumber(label, unit, default=first, bounds=ends, softbounds=ends, step=1)


# the numbers in texts and answers are computed again by the tests: where the core comes to others, they change here
LESSONS = (
    Lesson(
        "coasting",
        "Why coasting saves",
        "Steel wheels on steel rails roll easily: with its motors off, this metro train loses about 1 km/h every ten "
        "seconds. The brakes are another matter. Braking wastes the remaining kinetic energy, which grows with the "
        "square of the speed at which braking begins. The cheapest run therefore goes slightly faster at first, "
        "switches the motors off early, coasts, and brakes from a lower speed. The dashed run takes exactly the same "
        "time, but holds one constant speed and brakes from it. Both runs start and brake with full effort, and no "
        "energy is recuperated. The track is level and 1500 m long: too short for the optimum to hold a speed between "
        "acceleration and coasting.",
        "Allow more travel time. Does coasting save a larger or a smaller share?",
        "A larger one: 9.8 % at 95 s, 15.2 % at 160 s. A slower train coasts farther: running resistance uses up more "
        "of its kinetic energy, and the brakes waste less.",
        _slider("Travel time, s", "s", (95.0, 160.0), FIRST_VALUES["coasting"]),
    ),
    Lesson(
        "multiplier",
        "What the multiplier means",
        "The timetable is a constraint; the multiplier is its price. Allow one more second, and the least energy falls "
        "by the multiplier, which is the slope of the energy-time curve. This one number fixes the whole run: on level "
        "track it gives the speed to hold and the speed at which coasting ends. The phase plane shows how. Its "
        "horizontal axis is speed; its vertical axis is the value of one joule of kinetic energy, in joules from the "
        "supply. Above the upper line, a joule is worth more than it costs: full power. Below the lower line, it is "
        "worth less than braking recuperates, which is nothing here: brake. In between, neither pays: coast. The run "
        "starts at the top left and falls through all three regions.",
        "Shorten the travel time by 30 s, then by 10 s more. How does the energy saved per extra second grow?",
        "At 200 s, one extra second saves 152 Wh, at 170 s 293 Wh, at 160 s 505 Wh. The last seconds cost most: a "
        "little slack in the timetable is the cheapest way to save energy.",
        _slider("Travel time, s", "s", (158.0, 270.0), FIRST_VALUES["multiplier"]),
    ),
    Lesson(
        "recuperation",
        "When to recuperate instead of coast",
        "A train that recuperates wastes less energy when it brakes. Is coasting still right? Follow one joule of "
        "kinetic energy. The powertrain drew 1.18 joules from the supply to produce it; braking at once would "
        "recuperate at most 0.85. Coasting spends it on covering distance, which must be covered anyway. So coasting "
        "remains right as long as recuperation has losses, but there is less of it: the better the powertrain "
        "recuperates, the lower the speed that is held, the later the motors are switched off, and the higher the "
        "speed at which braking begins. In the phase plane, the lower line rises toward the upper one, and the "
        "coasting region narrows. It would close only if powertrain and supply had no losses. The dashed run "
        "recuperates nothing.",
        "Raise recuperation from 0 to 100 %. Where does coasting begin, and how much is saved?",
        "At 0 % the motors are switched off after 2.6 of 6 km, at 100 % after 3.9 km, and 16.6 % of the energy is "
        "saved. The train still coasts for 2 km: two conversions at 85 % would lose energy that coasting turns into "
        "distance.",
        _slider("Recuperation, %", "%", (0.0, 100.0), FIRST_VALUES["recuperation"]),
    ),
    Lesson(
        "gradient",
        "Why it pays to plan with gradients",
        "Many metros put their stations on humps: the track falls after the start and rises before the stop. The hump "
        "stores kinetic energy as height and returns it without loss, but only a plan with gradients makes use of "
        "this. The blue run is planned with gradients: it switches the motors off early, rolls down, and lets the "
        "climb slow the train. The dashed run was planned for level track, and its speeds are followed exactly over "
        "the hump: it brakes downhill and drives uphill, in the same time. No energy is recuperated here. Height "
        "itself costs nothing, because the train descends as much as it climbs. What costs energy is braking on one "
        "side and driving on the other.",
        "From which gradient on does the plan without gradients need twice the energy of the plan with gradients?",
        "From about 24 per mille. At 20 per mille the plan with gradients saves 45 %, at 30 per mille 57 %, although "
        "both runs arrive at the same time.",
        _slider("Gradient of the hump, \u2030", "\u2030", (0.0, 30.0), FIRST_VALUES["gradient"]),
    ),
    Lesson(
        "load",
        "What a wrong load costs",
        "The plan assumes a train that is 30 % full, but a different number of passengers boards. The controller "
        "follows the planned speeds as well as it can. A lighter train loses speed sooner when it coasts, and must use "
        "power where the plan coasts; a heavier one reaches the planned speed late, arrives later, and still has to "
        "brake. For comparison, a second run is planned for the actual load with the travel time of the driven run, so "
        "that only the plan differs. The speeds look almost the same, and so do the energies: on this track the wrong "
        "load costs about three percent and two seconds, little compared with the effect of the passengers' weight "
        "itself. On steep gradients it can cost more: see What if.",
        "Which costs more than its own best plan: an empty or a full train?",
        "Both cost about the same: the empty one needs 3.3 % more than its own best plan and is on time, the full one "
        "3.5 % more and arrives 2.2 s late.",
        _slider("Actual load, % of capacity", "%", (0.0, 100.0), FIRST_VALUES["load"]),
    ),
)
"""In the order in which they are read."""


def guess_field(lesson: str) -> str:
    """Return the name of the parameter that holds the guess of a lesson."""
    return f"{lesson}_guess"


GUESS_FIELDS = tuple(guess_field(lesson.name) for lesson in LESSONS)


class LearnModel(TypedParameters, PageModel):
    """Where the sliders stand, and what the lessons show."""

    kept = (*(lesson.name for lesson in LESSONS), *GUESS_FIELDS, "lesson", "driven", "shared", "drawn")
    passing = ("shown", "finished", "sharing", "sketched")

    coasting, multiplier, recuperation, gradient, load = (lesson.number for lesson in LESSONS)
    coasting_guess, multiplier_guess, recuperation_guess, gradient_guess, load_guess = (
        GUESSES[lesson.name].number() for lesson in LESSONS
    )
    lesson = param.Selector(
        default="", objects=["", *(lesson.name for lesson in LESSONS)], doc="The lesson that a link opens."
    )
    shown = param.Dict(default={}, doc="What each lesson shows.")
    driven = param.String(default="", doc="Commands of the last run that was driven by hand, such as p0c300b2200.")
    finished = param.String(default="", doc="Commands of a try that is to be judged.")
    tried = result(TryResult, "What the browser is told of it.")
    shared = param.String(default="", doc="The last sharing of slack that was judged, such as uneven:20,20,20.")
    sharing = param.String(default="", doc="A sharing that is to be judged.")
    slack = result(SlackResult, "What the browser is told of it.")
    drawn = param.String(default="", doc="The last drawing that was judged: speeds in km/h with commas between.")
    sketched = param.String(default="", doc="A drawing that is to be judged.")
    drawing = result(DrawingResult, "What the browser is told of it.")
