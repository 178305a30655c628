"""One number, one value: what is told of a run reads alike on the pages, in charts, in reports and on the command line.

The texts are those that the views, the report and the commands make; no expected number is written down here.
"""

import html
import re
from collections import defaultdict
from collections.abc import Iterator
from contextlib import redirect_stdout
from datetime import UTC, datetime
from io import StringIO

import pytest

from railjoule.core.strategies import STRATEGIES
from railjoule.dashboard.browser import Browser
from railjoule.dashboard.command.cli import main
from railjoule.dashboard.keep.keeping import Keeping
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.words import STRATEGY_WORDS
from railjoule.dashboard.page_host import PageHost
from railjoule.dashboard.page_work import PageWorks
from railjoule.dashboard.pages.start.cards import card_html
from railjoule.dashboard.pages.start.compute import make_card
from railjoule.dashboard.report.document import report_html
from railjoule.dashboard.report.findings import Findings
from railjoule.dashboard.shell.sidebar import Sidebar
from railjoule.dashboard.work.runs import RunsRequest, compute_runs, tightened_runs
from railjoule.dashboard.workbench import Workbench

FIGURE = re.compile(
    r"<div class=label><span>(?P<label>.*?)</span>.*?</div>"
    r"<div class=value>(?P<value>.*?)<span>(?P<unit>.*?)</span></div>"
    r"<div class=detail>(?P<detail>.*?)</div></div>"
)
NUMBER = r"-?[\d,]+(?:\.\d+)?"
NAMES = {word: name for name, word in STRATEGY_WORDS.items()}
CHART_NAMES = {"set speeds": "speed_limits"}
PALETTE = Palette(dark=False)

Told = dict[tuple[str, str], dict[str, str]]
"""What is told: by strategy and quantity, the text by the place where it stands."""


def plain(markup: str) -> str:
    """Return the text of some markup with the signs of a terminal: '1,080.0' and '-0.628'."""
    text = html.unescape(re.sub(r"<[^>]+>", " ", markup))
    return " ".join(re.sub("(?<=[0-9])\u202f(?=[0-9])", ",", text).replace("\u2212", "-").split())


def amount(text: str) -> str:
    """Return by how much something lies above, without its sign and its unit."""
    return text.removesuffix(" %").lstrip("+")


def rows_of(markup: str, first: str) -> Iterator[dict[str, str]]:
    """Yield the rows of a table of runs by the heads of its columns; `first` is what its first column is called."""
    for table in re.findall(r"<table[^>]*>.*?</table>", markup, re.DOTALL):
        head, *rows = re.split(r"<tr[^>]*>", table)[1:]
        heads = [plain(cell) for cell in re.split(r"<th [^>]*>", head)[1:]]
        if heads[0] == first:
            for row in rows:
                yield dict(zip(heads, [plain(cell) for cell in row.split("<td>")[1:]], strict=False))


def printed(*arguments: str) -> str:
    """Return what a command prints."""
    output = StringIO()
    with redirect_stdout(output):
        assert main(arguments) == 0
    return output.getvalue()


def make_sidebar(state: Workbench) -> Sidebar:
    browser = Browser()
    return Sidebar(state, browser, Keeping(state, browser))


class Teller:
    """Collects what one scenario's runs are told to be."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.told: Told = defaultdict(dict)
        self.state = Workbench()
        self.drive = PageHost(self.state.pages["Drive"], Browser(), PALETTE)
        self.sidebar = make_sidebar(self.state)
        PageHost(self.state.pages["Compare"], Browser(), PALETTE)
        self.compare = self.state.pages["Compare"]
        self.state.scenario.choose(name)
        self.first: str = self.state.chosen
        self.state.ticked = list(STRATEGIES)
        self.runs = compute_runs(RunsRequest(self.state.scenario.scenario(), tuple(STRATEGIES)))
        PageWorks(self.state.pages["Drive"])
        self.state.page = "Drive"
        self.state.runs = self.runs
        # the first stage of the proof is done by now: there is no page whose turn it waits for
        self.runs = self.state.runs

    def tell(self, place: str, strategy: str, **quantities: str | None) -> None:
        """Take down what a place tells of a run."""
        for quantity, text in quantities.items():
            if text is not None:
                self.told[strategy, quantity][place] = text

    def head(self, place: str, strategy: str, markup: str) -> None:
        """Read the row of numbers of Drive or of a report."""
        figures = {match["label"]: match for match in FIGURE.finditer(markup)}
        energy, time = figures["Energy from the supply"], figures["Travel time"]
        self.tell(place, strategy, energy=plain(energy["value"]), time=plain(time["value"]))
        if self.runs.runs[strategy].price_of_time_w is not None:
            self.tell(place, strategy, price=plain(figures["Extra second saves"]["value"]))
        above = next(match for label, match in figures.items() if label.startswith(("Above ", "Late", "Early")))
        off_time = "" if above["label"].startswith("Above") else f" {above['label'].lower()}"
        text = amount(plain(f"{above['value']} {above['unit']}")) + off_time
        bound = re.search(rf"bound ({NUMBER})", plain(above["detail"]))
        if "bound" in above["label"]:
            self.tell(place, strategy, above_bound=text)
        else:
            self.tell(place, strategy, above=text)
        self.tell(place, strategy, bound=bound and bound[1])
        if "Per tonne and km" in figures:
            length = re.search(rf"t, ({NUMBER}) km", plain(figures["Per tonne and km"]["detail"]))
            self.tell(place, "", distance=length and length[1])

    def pages(self) -> None:
        """Read Drive, the sidebar, Compare and their charts."""
        for name in self.runs.runs:
            self.state.chosen = name
            self.head("head", name, self.drive.figures.object)
        heading = re.search(rf"class=scenario>.*?</span> ({NUMBER}) km,", self.drive.heading.object)
        side = re.search(rf"({NUMBER}) km", plain(self.sidebar.line.object))
        self.tell("heading", "", distance=heading and heading[1])
        self.tell("sidebar", "", distance=side and side[1])
        self.runs_table("table", self.state.pages["Drive"].runs.object)
        for name, markup in self.sidebar.strategies.results.items():
            told = re.findall(r"<span>(.*?)</span>", markup)
            if name in self.runs.runs:
                self.tell("sidebar", name, energy=plain(told[0]), above=amount(plain(told[1])))
        chart = next(chart for chart in self.drive.charts if chart.name == "energy")
        for text in chart.sources["ends"].data["text"]:
            name, energy = text.rsplit(" ", 1)
            strategy = CHART_NAMES.get(name) or NAMES[name if name.isupper() else name.capitalize()]
            self.tell("chart", strategy, energy=plain(energy))
        self.state.page = "Compare"
        for row in rows_of(self.compare.table.object, "Run"):
            if row:
                name = NAMES[row["Run"]]
                # the run to which the sidebar refers is the reference
                self.tell("compare", name, energy=row["kWh"], time=row["s"], above=amount(row["vs reference, %"]))
        for text in self.compare.host.plots["compared_energy"].sources["names"].data["text"]:
            name, energy = text.rsplit(" ", 1)
            self.tell("compared", CHART_NAMES.get(name) or NAMES[name], energy=plain(energy))

    def runs_table(self, place: str, markup: str) -> None:
        """Read the table of runs of Drive or of a report."""
        for row in rows_of(markup, "Run"):
            if row and row["Run"] in NAMES:
                above = next(text for head, text in row.items() if head.startswith("above"))
                self.tell(place, NAMES[row["Run"]], energy=row["kWh"], time=row["s"], above=amount(above))

    def card(self) -> None:
        """Read the card on Start."""
        text = plain(card_html(make_card(self.name)).split("</button>")[1])
        length = re.search(rf"({NUMBER}) km(?!/h)", text)
        run = re.search(rf"(?:([A-Z][a-z ]+): )?({NUMBER}) kWh in ({NUMBER}) s", text)
        self.tell("card", "", distance=length[1])
        self.tell("card", NAMES[run[1] or "Optimal"], energy=run[2], time=run[3])
        self.tell("card", "", shown=run[1] or "Optimal")
        self.tell("drive", "", shown=STRATEGY_WORDS[self.first])

    def report(self) -> None:
        """Read a report; its figures and optima over other times have their own tests."""
        # as `compute_findings` makes them, whatever the page has proven
        runs = tightened_runs(compute_runs(RunsRequest(self.runs.scenario, tuple(STRATEGIES))))
        page = report_html(Findings(self.runs.scenario, runs=runs), datetime(2026, 1, 1, tzinfo=UTC))
        shown = page[: page.index('id="scenario"')]
        self.head("report", self.first, shown)
        self.runs_table("report's table", shown)
        length = re.search(rf'<p class="muted">({NUMBER}) km, ', shown)
        self.tell("report", "", distance=length and length[1])
        bound = re.search(rf"A bound of ({NUMBER}) kWh", plain(shown))
        self.tell("report's proof", self.runs.best.strategy, bound=bound and bound[1])

    def commands(self) -> None:
        """Read what the commands `compare` and `solve` print for people."""
        _, line, _, head, rule, *rows = printed("compare", self.name).splitlines()
        length = re.match(rf"({NUMBER}) (?:km|m),", line)
        self.tell("command", "", distance=length and length[1])
        ends = [match.span() for match in re.finditer("-+", rule)]
        heads = [head[start:end].strip() for start, end in ends]
        for row in rows:
            cells = dict(zip(heads, (row[start:end].strip() for start, end in ends), strict=True))
            if cells["strategy"] not in NAMES or cells["strategy"] == row.strip():
                break
            above = next(
                text for head, text in cells.items() if head.startswith(("above opt", "above best", "against"))
            )
            bound = cells.get("above bound, %")
            name = NAMES[cells["strategy"]]
            self.tell("command", name, energy=cells["kWh"], time=cells["time, s"], above=amount(above))
            self.tell("command", name, above_bound=bound and amount(bound))
        solved = " ".join(printed("solve", self.name).split())
        # a run over nodes of its own may have no bound
        told = re.search(rf"Energy ({NUMBER}) kWh .*?(?: Bound ({NUMBER}) kWh\. .*?)? Time ({NUMBER}) s", solved)
        saved = re.search(rf"would save ({NUMBER}) Wh", solved)
        self.tell("solve", self.first, energy=told[1], bound=told[2], time=told[3], price=saved and saved[1])


# one of each kind: all strategies, loss table without an early proof, gradients, replanning, and at night stations
SCENARIOS = (
    "ftorek-300s",
    "kharkiv-like-40kmh",
    "liashenko-ii",
    "tram-950m-stop",
    pytest.param("metro-10-stations", marks=pytest.mark.nightly),
)


@pytest.fixture(scope="module", params=SCENARIOS)
def teller(request: pytest.FixtureRequest) -> Teller:
    """What is told of a shipped scenario's runs."""
    teller = Teller(request.param)
    teller.pages()
    teller.card()
    teller.report()
    teller.commands()
    return teller


def test_what_is_told_of_a_run_reads_alike_everywhere(teller: Teller) -> None:
    assert not {key: texts for key, texts in teller.told.items() if len(set(texts.values())) > 1}


def test_each_quantity_is_read_where_it_stands(teller: Teller) -> None:
    """Lest the test above compare nothing."""
    told, first = teller.told, teller.first
    assert told["", "distance"].keys() == {"head", "heading", "sidebar", "card", "report", "command"}
    everywhere = {"head", "table", "compare", "card", "report", "report's table", "command", "solve"}
    assert told[first, "time"].keys() == everywhere
    assert told[first, "energy"].keys() == {*everywhere, "sidebar", "chart", "compared"}
    for name in teller.runs.runs:
        assert told[name, "above"].keys() >= {"sidebar", "table", "compare", "report's table", "command"}
    assert "head" in told["fastest", "above"]
    assert ("solve" in told[first, "bound"]) == (teller.runs.runs[first].lower_bound_kwh is not None)
