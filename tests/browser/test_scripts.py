"""The page's scripts by themselves, in a blank page: as they are sent, what they compute, rules of the house."""

import math
import re
from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, Route

from railjoule.core.simulation.manual import drive_manually, read_commands
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.browser import bar_html
from railjoule.dashboard.editor.forms import table_html
from railjoule.dashboard.look.scripts import SCRIPTS, module, source
from railjoule.dashboard.pages.drive.charts import Player
from railjoule.dashboard.pages.learn.by_hand import lesson, mesh_arrays
from railjoule.dashboard.pages.learn.driven import lesson_html
from railjoule.dashboard.shell.strategies import strategy_rows

ADDRESS = "http://scripts.invalid/"
NAMES = sorted(path.name.removesuffix(".js") for path in SCRIPTS.iterdir() if path.name.endswith(".js"))
MODULES = [name for name in NAMES if re.search(r"^export ", source(name), re.MULTILINE)]
COMPONENTS = [name for name in MODULES if "export function render(" in source(name)]
LISTENING_OUTSIDE = [
    name for name in COMPONENTS if re.search(r"\b(window|document)\.addEventListener|matchMedia", module(name))
]
"""Components that listen to the window, the document or the system."""
KNOWS_ALL_ROOTS = "first"
"""The one script that leaves something on the window."""


@pytest.fixture(scope="module")
def page(chromium: Browser) -> Iterator[Page]:
    """A blank page of an address from which the scripts can be imported, errors seen."""
    context = chromium.new_context()
    page = context.new_page()
    page.route(f"{ADDRESS}**", answer)
    page.goto(ADDRESS)
    page.evaluate(source(KNOWS_ALL_ROOTS))
    yield page
    context.close()


def answer(route: Route) -> None:
    """Answer with a script of the assets, or with an empty page."""
    name = route.request.url.removeprefix(ADDRESS)
    if name.endswith(".js"):
        route.fulfill(body=source(name.removesuffix(".js")), content_type="text/javascript")
    else:
        route.fulfill(body="<!DOCTYPE html><title>scripts</title>", content_type="text/html")


def run(page: Page, name: str, code: str, argument: Any = None) -> Any:
    """Return what the body of an asynchronous function gives, with a module's exports as `m` and an argument as `a`."""
    told = f"async (a) => {{ const m = await import('{ADDRESS}{name}.js'); {code} }}"
    return page.evaluate(told, argument)


def exports_of(name: str) -> set[str]:
    """Return what a module exports: one name, or several taken out of an object."""
    lists = re.findall(r"^export (?:const|function) (\{[^}]+\}|\w+)", source(name), re.MULTILINE)
    return {one for names in lists for one in re.findall(r"\w+", names)}


# --- as they are sent


@pytest.mark.parametrize("name", MODULES)
def test_a_module_is_sent_as_one(page: Page, name: str) -> None:
    """Names that two modules share, and what is left of an import, would be errors of syntax or of loading."""
    text = module(name)
    assert not re.search(r"^import ", text, re.MULTILINE)
    exports = page.evaluate(
        """async (text) => {
          const url = URL.createObjectURL(new Blob([text], {type: "text/javascript"}));
          return Object.keys(await import(url));
        }""",
        text,
    )
    assert set(exports) == exports_of(name)


@pytest.mark.parametrize("name", sorted(set(NAMES) - set(MODULES)))
def test_a_plain_script_is_strict_and_parses(page: Page, name: str) -> None:
    assert '"use strict";' in source(name)
    page.evaluate("text => { new Function(text); }", source(name))


@pytest.mark.parametrize("name", NAMES)
def test_house_rules(name: str) -> None:
    """What the linter does not know: nothing is left on the window, and no value is spelt with two backslashes."""
    text = source(name)
    left = re.findall(r"\b(?:window|globalThis|self)\.\w+(?:\.\w+)* \??\??=(?!=)", text)
    assert left == (["window.railjoule ="] if name == KNOWS_ALL_ROOTS else [])
    assert "\\\\u" not in text
    assert text.startswith("// "), "what is it for?"


# --- components, with a model that only listens

MODEL = """
const told = [], watchers = {};
const model = {...a, send_msg: (message) => told.push(message), on: (name, act) => (watchers[name] ??= []).push(act)};
const change = (values) => {
  Object.assign(model, values);
  for (const name of Object.keys(values)) { (watchers[name] ?? []).forEach((act) => act()); }
};
const drawn = () => new Promise((resolve) => queueMicrotask(resolve));
const remove = () => (watchers.remove ?? []).forEach((act) => act());
const shown = (host) => { document.body.replaceChildren(host); return host; };
"""
LISTENING = """
window.Bokeh = {documents: []};
const heard = new Set(), {addEventListener, removeEventListener} = EventTarget.prototype;
EventTarget.prototype.addEventListener = function (name, listener, options) {
  if (!(this instanceof Element) && !(this instanceof AbortSignal)) {
    heard.add(listener);
    options?.signal && addEventListener.call(options.signal, "abort", () => heard.delete(listener));
  }
  return addEventListener.call(this, name, listener, options);
};
EventTarget.prototype.removeEventListener = function (name, listener, options) {
  heard.delete(listener);
  return removeEventListener.call(this, name, listener, options);
};
"""
LISTENED = "Object.assign(EventTarget.prototype, {addEventListener, removeEventListener});"
NUMBER: dict[str, Any] = {
    "label": "Travel time, s",
    "of": "",
    "unit": "s",
    "digits": 1,
    "info": "",
    "narrow": False,
    "value": 170.0,
    "suggested": None,
    "original": [170.0],
    "start": 147.0,
    "end": 341.25,
    "step": 0.5,
    "tick": 200.0,
    "note": "",
    "hint": "",
    "refusal": "",
    "answers": 0,
}
VALUES: dict[str, dict[str, Any]] = {
    "browser": {
        "page": "Start",
        "bar": bar_html(),
        "pages": ["Start", "Drive"],
        "bare": [],
        "keyed": ["Start", "Drive"],
        "labels": {"undo": "Undo"},
        "disabled": [],
        "charts_in_sight": [],
        "address": "",
        "progress": None,
    },
    "drive_it": {"html": lesson_html(), "sources": {}, "given": {}, "verdict": {}, "refusals": 0, "lead": ""},
    "editor_head": {"status": "", "alert": "", "open": False},
    "loop_diagram": {"drawing": "<svg></svg>", "charts": {}},
    "number_field": NUMBER,
    "player": {"html": Player.param["html"].default, "wanted": False, "run": {}, "train": [], "over_time": False},
}
"""Properties that each of the listening components needs to be drawn."""


@pytest.mark.parametrize("name", LISTENING_OUTSIDE)
def test_a_component_lets_go_of_all_that_outlives_it(page: Page, name: str) -> None:
    """Whether it is removed or only drawn anew: the library does not tell of the second."""
    document = "on_event() {}, on_change() {}, remove_on_change() {}, get_model_by_name() {}"
    view = f"view: {{model: {{document: {{{document}}}}}}}"
    code = f"""
      {MODEL} {LISTENING}
      const counts = [];
      for (let k = 0; k < 2; k++) {{
        document.body.replaceChildren(m.render({{model, el: document.body, {view}}}));
        counts.push(heard.size);
      }}
      remove();
      {LISTENED}
      return [...counts, heard.size];
    """
    first, second, left = run(page, name, code, VALUES[name])
    assert first == second
    assert left == 0


def test_a_tick_outlasts_numbers_that_come_before_its_answer(page: Page) -> None:
    code = f"""
      {MODEL}
      const host = shown(m.render({{model}}));
      const [one, two] = host.querySelectorAll("input.draw"), [first, second] = host.querySelectorAll("[type=radio]");
      const state = () => [one.checked, two.checked, first.checked, second.checked];
      const seen = [];
      two.click();
      change({{results: {{a: "1", b: "2"}}}});
      seen.push(state());
      change({{ticked: ["b"]}});
      change({{ticked: []}});
      seen.push(state());
      second.click();
      change({{results: {{a: "3", b: "4"}}}});
      seen.push(state());
      change({{chosen: "b"}});
      change({{chosen: "a"}});
      seen.push(state());
      return [told.map((message) => message.kind), ...seen];
    """
    html = strategy_rows({"a": "a", "b": "b"})
    start = {"html": html, "chosen": "a", "ticked": [], "results": {}, "above": "", "unknown": "", "draws": True}
    start |= {"hidden": [], "refusals": ""}
    assert run(page, "strategies", code, start) == [
        ["draw", "choose"],
        [True, True, True, False],
        # confirmed, and then undone by the server
        [True, False, True, False],
        # the one that all numbers speak of is always drawn
        [False, True, False, True],
        [True, False, True, False],
    ]


FIELD = f"""
  {MODEL}
  const host = shown(m.render({{model}}));
  const slider = host.querySelector("[type=range]"), text = host.querySelector("[type=text]");
  const error = host.querySelector("[role=alert]"), mark = host.querySelector("[role=img]");
  const slide = (to) => {{ slider.value = to; slider.dispatchEvent(new Event("input")); }};
  const type = (words) => {{ text.focus(); text.value = words; text.dispatchEvent(new Event("change")); }};
  const key = (element, name, more = {{}}) =>
    element.dispatchEvent(new KeyboardEvent("keydown", {{key: name, bubbles: true, cancelable: true, ...more}}));
  const rest = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));
"""


def test_a_slider_writes_its_number_and_sends_the_first_and_the_last_of_many(page: Page) -> None:
    code = f"""
      {FIELD}
      const given = [];
      let value = model.value;
      Object.defineProperty(model, "value", {{get: () => value, set: (next) => {{ given.push(next); value = next; }}}});
      const before = [mark.hidden, text.value, slider.getAttribute("aria-valuetext")];
      for (const to of [180, 181, 182.5]) {{ slide(to); }}
      // what the server has to say of the first
      change({{note: "heavy"}});
      const at_once = [...given, slider.value, text.value];
      await rest(150);
      const after = [mark.hidden, text.value, slider.getAttribute("aria-valuetext"), mark.title];
      slide(400);
      // a step back is of what the slider was moved to
      slide(300);
      key(slider, "z", {{ctrlKey: true}});
      return {{before, at_once, after, given, label: host.querySelector("label").control === slider}};
    """
    seen = run(page, "number_field", code, NUMBER)
    assert seen == {
        "before": [True, "170.0", "170.0 s"],
        "at_once": [180, "182.5", "182.5"],
        "after": [False, "182.5", "182.5 s", "changed: was 170.0 s"],
        # the end is no whole number of steps away from the start
        "given": [180, 182.5, 341.25, 300],
        "label": True,
    }


def test_the_server_does_not_move_a_thumb_that_is_held(page: Page) -> None:
    code = f"""
      {FIELD}
      slider.dispatchEvent(new Event("pointerdown"));
      slide(180);
      change({{value: 190, note: "heavy"}});
      const held = [slider.value, text.value, host.querySelector(".note").textContent];
      window.dispatchEvent(new Event("pointerup"));
      return [...held, slider.value, text.value];
    """
    assert run(page, "number_field", code, NUMBER) == ["180", "180.0", "heavy", "190", "190.0"]


def test_a_number_that_is_not_set_and_one_without_a_slider(page: Page) -> None:
    nothing = {**NUMBER, "value": None, "original": [None]}
    code = f"""
      {FIELD}
      const empty = [text.value, slider.value, mark.hidden];
      change({{suggested: 160}});
      const suggested = [text.value, slider.value, mark.hidden];
      change({{value: 150}});
      return [...empty, ...suggested, mark.title];
    """
    seen = run(page, "number_field", code, nothing)
    assert seen == ["", "147", True, "160.0", "160", True, "changed: was not set"]
    plain = {**NUMBER, "start": None, "end": None, "step": None, "of": "Stop 1: ", "note": "heavy", "original": []}
    code = f"""
      {FIELD}
      return [slider, text.ariaLabel, host.querySelector("label").control === text, mark.hidden,
        host.querySelector(".note").textContent];
    """
    assert run(page, "number_field", code, plain) == [
        None,
        "Stop 1: Travel time, s, as a number",
        True,
        True,
        "heavy",
    ]


@pytest.mark.parametrize(
    ("number", "digits", "text"),
    [
        (50.5, 0, "50.5"),
        (33.25, 0, "33.25"),
        (7.1, 0, "7.1"),
        (50, 1, "50.0"),
        (100 / 3, 0, "33"),
        (100 * 0.29, 0, "29"),  # 28.999999999999996
        (-12345.678, 0, "\u221212\u202f345.678"),
    ],
)
def test_typed_decimals_are_shown_and_computed_ones_rounded(page: Page, number: float, digits: int, text: str) -> None:
    assert run(page, "number_field", "return m.shown(a.number, a.digits)", {"number": number, "digits": digits}) == text


def test_a_table_tells_its_cell_and_moves_by_key(page: Page) -> None:
    columns = [{"key": key, "label": key, "kind": "number", "help": ""} for key in ("length", "gradient")]
    table = {
        "columns": columns,
        "rows": [["1", "2"], ["3", "4"]],
        "label": "Sections",
        "help": "",
        "more": "",
        "changed": False,
    }
    code = f"""
      {MODEL}
      const host = shown(m.render({{model}})), inputs = [...host.querySelectorAll("input[type=text]")];
      inputs[0].focus();
      inputs[0].dispatchEvent(new KeyboardEvent("keydown", {{key: "ArrowDown", bubbles: true}}));
      const now = inputs.indexOf(document.activeElement);
      inputs[3].value = "5";
      inputs[3].dispatchEvent(new Event("change", {{bubbles: true}}));
      host.querySelector("[aria-label='Remove row 2']").click();
      return {{now, told, names: inputs.map((input) => input.ariaLabel)}};
    """
    seen = run(page, "table_form", code, {"table": table, "html": table_html(table), "version": 0})
    assert seen["now"] == 2
    assert seen["told"] == [{"what": "cell", "row": 1, "column": 1, "text": "5"}, {"what": "remove", "row": 1}]
    assert seen["names"] == ["length, row 1", "gradient, row 1", "length, row 2", "gradient, row 2"]


# --- what they compute


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (1234567.5, (1,), "1\u202f234\u202f567.5"),
        (-1500, (0,), "\u22121\u202f500"),
        (-0.04, (1,), "0.0"),
        (0.25, (0, 3), "0.25"),
    ],
)
def test_numbers_as_people_read_them(page: Page, value: float, digits: tuple[int, ...], text: str) -> None:
    assert run(page, "numbers", "return m.written(a.value, ...a.digits)", {"value": value, "digits": digits}) == text
    assert run(page, "actions", "return Number(m.plain(a))", text) == pytest.approx(value, abs=0.05)


def test_a_tick_has_its_digits_and_more_where_it_needs_them(page: Page) -> None:
    told = run(page, "numbers", "return a.map((tick) => m.written(tick, 1, 3))", [-2000, 0.5, 0.125])
    assert told == ["\u22122\u202f000.0", "0.5", "0.125"]


def test_the_value_of_a_line_beneath_the_mouse(page: Page) -> None:
    line = {"x": [0, 10, 10, 30], "y": [0, 5, 7, 9]}
    code = "return [[0], [5], [20], [20, true], [-1], [31]].map(([x, stepped]) => m.value_at(a, x, stepped))"
    # straight between the nodes; a cell has the value of its end
    assert run(page, "cursor", code, line)[:4] == [0, 2.5, 8, 9]
    assert all(math.isnan(value) for value in run(page, "cursor", code, line)[4:])


def test_each_axis_has_a_cursor_of_its_own(page: Page) -> None:
    chart = {"words": "Speed", "unit": "km/h", "digits": 1, "small": 0, "stepped": False, "place": ["m", 0]}
    code = """
      const lines = [["", "run", "place", "speed"], ["clock", "day", "x", "y"]];
      const axis = () => ({range: {}, captions: [{text: "", tags: [{...a, sources: lines}]}],
        sources: {run: {data: {place: [0, 100], speed: [0, 50]}}, day: {data: {x: [], y: []}}}});
      const [one, other] = [axis(), axis()], text = ({captions}) => captions[0].text;
      m.follow(one, {event_name: "mousemove", x: 20});
      const first = text(one);
      // both axes settle: only one of them has a mouse
      one.sources.run.data.speed[1] = 100;
      m.follow(one, one.range);
      m.follow(other, other.range);
      const [moved, untouched] = [text(one), text(other)];
      m.follow(one, {event_name: "mouseleave"});
      return [first, moved, untouched, text(one)];
    """
    texts = run(page, "cursor", code, chart)
    assert texts == ["Speed&ensp;&ensp;20 m: 10.0 km/h", "Speed&ensp;&ensp;20 m: 20.0 km/h", "", "Speed"]


def test_a_drag_holds_the_nearest_grip_of_its_own_figure(page: Page) -> None:
    code = """
      const [one, other] = [{}, {}], grips = () => [{k: 1, away: 9}, {k: 2, away: 5}, {k: 3, away: 30}];
      const on = (figure, event_name) => m.held_by(figure, {event_name}, grips, 16)?.k ?? null;
      return [on(one, "panstart"), on(other, "pan"), on(one, "pan"), on(one, "panend"), on(one, "pan")];
    """
    assert run(page, "drag", code) == [2, None, 2, 2, None]


def test_a_border_stays_between_its_neighbours_and_no_steeper_than_allowed(page: Page) -> None:
    code = "return m.moved_border({x: [0, 100, 300], y: [0, 0, 0]}, a.k, a.to, a.bounds)"
    bounds = {"shortest": 1, "steepest_permille": 200, "bottom": -50, "top": 50}
    moved = run(page, "drag_heights", code, {"k": 1, "to": {"x": 500, "y": 2}, "bounds": bounds})
    # 1 m before the end, where 200 per mille allow 0.2 m
    assert moved == {"x": 299, "y": pytest.approx(0.2), "climbs": [pytest.approx(200 / 299), pytest.approx(-200)]}
    last = run(page, "drag_heights", code, {"k": 2, "to": {"x": 7, "y": 99}, "bounds": bounds})
    # the end of the track is not moved along it: 200 per mille of 200 m
    assert last == {"x": 300, "y": 40, "climbs": [200]}


def test_a_border_that_is_dragged_upwards_stays_at_its_place(page: Page) -> None:
    code = """
      const nodes = {data: {x: [0, 400.5, 900], y: [0, -2, 1]}, change: {emit() {}}}, sign = {}, dropped = {};
      const f = {inner_width: 900, inner_height: 100, x_range: {start: 0, end: 900}, y_range: {start: -10, end: 10}};
      const drag = (event_name, x, y) => m.drag_heights({f, nodes, sign, dropped, steepest: 200, shortest: 1},
        {event_name, x, y});
      drag("panstart", a[0][0], a[0][1]);
      for (const [x, y] of a.slice(1)) { drag("pan", x, y); }
      drag("panend", ...a.at(-1));
      return [dropped.data.x[1], dropped.data.y[1]];
    """
    # a pixel is 1 m and 0.2 m
    assert run(page, "drag_heights", code, [[400, -2.2], [401, 1], [398, 4]]) == [400.5, 4]
    assert run(page, "drag_heights", code, [[400, -2.2], [450, -1.8]]) == [450, -2]
    assert run(page, "drag_heights", code, [[400, -2.2], [450, 2], [402, 3]]) == [402, 3]


def test_a_limit_is_held_by_its_middle_and_some_by_their_ends(page: Page) -> None:
    steps = {"left": [0, 100], "right": [100, 200], "limit": [60, 40], "movable": [0, 9]}
    code = "return m.step_grips(a.steps, a.at, {x: 1, y: 1}, a.shared).map(({part, k}) => [part, k])"
    near = run(page, "drag", code, {"steps": steps, "at": {"x": 50, "y": 58}, "shared": False})
    assert near == [["limit", 0], ["left", 1], ["right", 1]]


def test_an_end_that_neighbours_share_is_held_anywhere_between_their_levels(page: Page) -> None:
    steps = {"left": [0, 100], "right": [100, 200], "limit": [60, 40], "movable": [9, 0]}
    code = "return m.step_grips(a, {x: 103, y: 50}, {x: 1, y: 1}, true).find(({part}) => part === 'right')"
    assert run(page, "drag", code, steps) == {"part": "right", "k": 0, "away": 3}


def test_a_station_moves_in_tenths_of_a_second_as_far_as_its_legs_have_time(page: Page) -> None:
    points = {"rest": [20, 15], "time": [94.83, 191.4], "low": [0.1, 0.1], "high": [34.9, 40]}
    code = "return m.moved_time(a.points, a.k, a.height)"
    moved = run(page, "drag", code, {"points": points, "k": 0, "height": 22.5})
    # 2.5 s later, in tenths
    assert moved == {"to": pytest.approx(97.3), "y": pytest.approx(20 + 97.3 - 94.83)}
    # no further than to the end of the slack
    assert run(page, "drag", code, {"points": points, "k": 0, "height": 90})["to"] == pytest.approx(109.7)
    assert run(page, "drag", code, {"points": points, "k": 1, "height": -5})["to"] == pytest.approx(176.5)


def test_set_speeds_move_in_halves_and_ends_between_their_neighbours(page: Page) -> None:
    before = {
        "left": [0, 100, 200],
        "right": [100, 200, 300],
        "limit": [60, 40, 50],
        "middle": [50, 150, 250],
        "text": ["60", "40", "50"],
    }
    code = """
      const bounds = {least: 5, most: 80, per: 2, shortest: 10, shared: true};
      m.move_step(a.steps, a.held, a.to, bounds);
      return a.steps;
    """
    limit = run(page, "drag", code, {"steps": before, "held": {"part": "limit", "k": 1}, "to": {"x": 0, "y": 44.3}})
    assert limit == {**before, "limit": [60, 44.5, 50], "text": ["60", "44.5", "50"]}
    end = run(page, "drag", code, {"steps": before, "held": {"part": "right", "k": 0}, "to": {"x": 250, "y": 0}})
    assert end == {**before, "right": [190, 200, 300], "left": [0, 190, 200], "middle": [95, 195, 250]}


def test_the_server_gets_steps_while_they_move_or_once_they_are_let_go(page: Page) -> None:
    code = """
      const sent = [], emit = () => {};
      const data = {left: [0], right: [100], limit: [50], middle: [50], text: ["50"], movable: [0]};
      const steps = {data, change: {emit}};
      const moved = {set data(to) { sent.push(to.limit[0]); }};
      const f = {inner_width: 100, inner_height: 100, x_range: {start: 0, end: 100}, y_range: {start: 0, end: 100}};
      const given = {f, steps, moved, live: a, least: 1, most: 80, per: 1, shortest: 1, end: 100, shared: false};
      for (const [event_name, y] of [["panstart", 50], ["pan", 60], ["pan", 90], ["panend", 90]]) {
        m.drag_steps(given, {event_name, x: 50, y});
      }
      return sent;
    """
    assert run(page, "drag", code, True) == [50, 60, 80]
    assert run(page, "drag", code, False) == [80]


def test_a_table_is_sorted_by_its_numbers(page: Page) -> None:
    order = run(page, "actions", "return a.sort(m.compared)", ["\u2013", "10", "\u22122", "9", "b", "a"])
    assert order[:3] == ["\u22122", "9", "10"]


def test_a_text_is_copied_where_there_is_no_clipboard(page: Page) -> None:
    code = """
      document.body.replaceChildren();
      const areas = [], {execCommand} = document;
      document.execCommand = (what) => { areas.push([what, document.activeElement.value]); return true; };
      const done = await m.copy_text("3.2 kWh");
      document.execCommand = execCommand;
      return {secure: isSecureContext, done, areas, left: document.querySelectorAll("textarea").length};
    """
    assert run(page, "files", code) == {"secure": False, "done": True, "areas": [["copy", "3.2 kWh"]], "left": 0}


def test_a_quick_hand_draws_what_it_leaves_out(page: Page) -> None:
    code = """
      const drawn = {data: {x: [0, 50, 100, 150, 200], y: [80, 80, 80, 80, 80]}, change: {emit() {}}}, dropped = {};
      const on = (event_name, x, y) => m.draw_line({f: a, drawn, dropped, least: 5, most: 80}, {event_name, x, y});
      on("panstart", 52, 40);
      on("pan", 201, 70.4);
      const on_the_way = [...drawn.data.y];
      on("panend", 300, -9);
      const dragged = [...dropped.data.y];
      on("tap", 0, 99.4);
      return [on_the_way, dragged, dropped.data.y];
    """
    assert run(page, "draw_line", code, {}) == [[80, 40, 50, 60, 70], [80, 40, 50, 60, 5], [80, 40, 50, 60, 5]]


# --- what is driven by hand


@pytest.mark.parametrize("text", ["p0", "p0c45p440c520b1080", "p0c24b200c260p330c600b900p1000", "p0b3p90c91p700c1000"])
def test_a_run_by_hand_has_the_numbers_of_the_library(page: Page, text: str) -> None:
    """Speeds, time and each part of the account, of runs that power, coast, brake, crawl and meet protection."""
    scenario, mesh = lesson()
    commands = read_commands(text, mesh.cell_count)
    driven = drive_manually(scenario, mesh, commands)
    code = """
      const {commands} = a, speed2 = [a.mesh.entering2];
      let sum = m.nothing_yet();
      commands.forEach((command, i) => {
        speed2.push(m.next_speed2(a.mesh, i, speed2[i], command));
        sum = m.with_cell(a.mesh, sum, i, speed2[i], speed2[i + 1]);
      });
      return {speed2, sum, letters: m.in_letters(commands)};
    """
    found = run(page, "driving", code, {"commands": commands.tolist(), "mesh": mesh_arrays(mesh)})
    account, sum_ = driven.energy, found["sum"]
    assert found["letters"] == text
    assert [math.sqrt(one) for one in found["speed2"]] == pytest.approx(driven.node_speed_ms.tolist(), abs=1e-6)
    assert sum_["time"] == pytest.approx(driven.travel_time_s, rel=1e-6)
    wanted = {
        "drawn": account.traction_j,
        "returned": account.recuperated_j,
        "resistance": account.running_resistance_j + account.curve_resistance_j,
        "losses": sum(account.losses_j.values()),
        "height": account.potential_j,
        "motion": account.kinetic_j,
    }
    for name, energy in wanted.items():
        # a ten-thousandth of a kilowatt hour, where a part may be zero
        assert sum_[name] == pytest.approx(energy, rel=1e-6, abs=1e-4 * J_PER_KWH), name


def test_a_train_goes_on_in_the_cell_that_it_is_in(page: Page) -> None:
    """By many small steps or a few: the account between two nodes grows up to that of the next."""
    code = """
      const trip = m.set_off(a), ends = m.set_off(a), energies = [];
      for (let k = 0; k < 50; k++) { trip.drive(0.1, () => m.POWER); energies.push(trip.now().sum.drawn); }
      ends.drive(5, () => m.POWER);
      const there = trip.now(), at_once = ends.now();
      while (!trip.has_arrived()) { trip.drive(10, () => m.POWER); }
      return {energies, there, at_once, cells: trip.run.commands.length, end: trip.now().at};
    """
    mesh = mesh_arrays(lesson()[1])
    found = run(page, "driving", code, mesh)
    assert found["energies"] == sorted(found["energies"])
    assert found["there"]["at"] == pytest.approx(found["at_once"]["at"])
    assert found["there"]["sum"] == pytest.approx(found["at_once"]["sum"])
    assert (found["cells"], found["end"]) == (len(mesh["length"]), mesh["position"][-1])


def test_a_ghost_is_where_the_run_was_at_the_time(page: Page) -> None:
    """At a node, within a cell with the speed rising evenly over time, and at the end."""
    code = "return a.times.map((time) => m.place_at(a.mesh, a.run, time));"
    given = {
        "mesh": {"position": [0, 10, 30]},
        "run": {"times": [0, 2, 4], "speeds": [0, 10, 10]},
        "times": [0, 1, 2, 3, 9],
    }
    found = run(page, "driving", code, given)
    assert [one["at"] for one in found] == pytest.approx([0, 2.5, 10, 20, 30])
    assert [one["speed"] for one in found] == pytest.approx([0, 5, 10, 10, 10])


def test_the_player_shows_the_run_at_a_time(page: Page) -> None:
    """The columns come when they are wanted; the slider sets the time, and Play asks for the run before it has one."""
    code = f"""
      {MODEL}
      window.Bokeh = {{documents: []}};
      const root = shown(m.render({{model}}));
      const button = root.querySelector("button"), range = root.querySelector("input");
      const texts = () => [...root.querySelectorAll(".readouts b")].map((one) => one.textContent);
      range.dispatchEvent(new Event("input"));
      const wanted = model.wanted;
      change({{run: {{
        time: [0, 10, 20], position: [0, 50, 200], speed: [0, 36, 72], power: [0, 1, 2], energy: [0, 1, 3],
        height: [0, 0, 0], starts: [0, 12],
      }}}});
      await drawn();
      range.value = "15";
      range.dispatchEvent(new Event("input"));
      const there = texts();
      button.click();
      const playing = button.textContent;
      button.click();
      const numbers = [11, 12].map((time) => m.instruction_at([0, 12], time));
      return [wanted, there, playing, button.textContent, ...numbers];
    """
    wanted, there, playing, stopped, before, after = run(page, "player", code, VALUES["player"])
    assert wanted
    # between the nodes, but for the power, which the cell has; without a current, there is no number of it
    assert there == ["15.0", "125", "54.0", "2.00", "\u2013", "2.00"]
    assert (playing, stopped, before, after) == ("Pause", "Play", 0, 1)
