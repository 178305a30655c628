// The lesson on slack: seconds dragged from leg to leg until a second more saves alike everywhere, then the best sharing.

import {life_of, make, redraw_on} from "./dom.js";
import {come_into_sight, figures_of, link_button, pressing, with_sign} from "./played.js";
import {equal_share, moved, price_of, sharing_text, total_kwh} from "./slack.js";

const KEY_STEPS = {ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 5, PageDown: -5};
const NEXT = {uneven: "even", even: "uneven"};
const WORDS = {
  even: "Next: a line with legs alike", uneven: "Back to the line with uneven legs",
};

export function render({model}) {
  const signal = life_of(model), root = make("section", {class: "played share-out", "aria-label": "Share out the slack"});
  const button = pressing(signal), told = make("p", {role: "status"}), split = make("div", {class: "split"});
  const legs = make("div", {class: "bars"}), total = make("b"), against = make("small"), steps = make("div", {class: "row"});
  const result = make("div", {hidden: true});
  let name = "", line = null, seconds = [], asked = false, parts = null;

  const text = () => sharing_text(name, seconds);
  const show = () => {
    // one scale as long as no price passes it, so that a bar's length can be compared with that before
    const widest = Math.max(...line.legs.flatMap((_, k) => [1.5 * price_of(line, equal_share(line), k), price_of(line, seconds, k)]));
    const slack = line.slack_s;
    let before = 0;
    seconds.forEach((one, k) => {
      const price = price_of(line, seconds, k), {share, fill, value, own, border} = parts[k];
      share.style.width = `${(100 * one) / slack}%`;
      share.firstChild.textContent = `${one} s`;
      fill.style.width = `${(100 * price) / widest}%`;
      value.textContent = figures_of(price, price < 100 ? 1 : 0);
      own.textContent = figures_of(line.legs[k].energy_kwh[one - line.min_s], 2);
      before += one;
      if (border) {
        border.style.left = `${(100 * before) / slack}%`;
        border.setAttribute("aria-valuemin", String(before - one + line.min_s));
        border.setAttribute("aria-valuemax", String(before + seconds[k + 1] - line.min_s));
        border.setAttribute("aria-valuenow", String(before));
        border.setAttribute("aria-valuetext", `${one} s for the leg before it, ${seconds[k + 1]} s for the leg after it`);
      }
    });
    const kwh = total_kwh(line, seconds);
    total.textContent = `${figures_of(kwh, 2)} kWh`;
    against.textContent = `${with_sign(kwh - total_kwh(line, equal_share(line)), 2)} kWh against equal slack`;
  };
  const move = (k, by) => {
    if (asked) { return; }
    const next = moved(seconds, k, by, line.min_s);
    if (next[k] === seconds[k]) { return; }
    seconds = next;
    result.hidden = true;
    reveal.disabled = false;
    for (const mark of split.querySelectorAll(".best")) { mark.remove(); }
    told.textContent = "";
    show();
  };
  const held = (border, k) => {
    border.addEventListener("pointerdown", (event) => {
      border.setPointerCapture(event.pointerId);
      border.focus();
      event.preventDefault();
    }, {signal});
    border.addEventListener("pointermove", (event) => {
      if (!border.hasPointerCapture(event.pointerId)) { return; }
      const box = split.getBoundingClientRect(), before = seconds.slice(0, k + 1).reduce((sum, one) => sum + one, 0);
      move(k, Math.round((line.slack_s * (event.clientX - box.left)) / box.width) - before);
    }, {signal});
    border.addEventListener("keydown", (event) => {
      const ends = {Home: -line.slack_s, End: line.slack_s}, by = KEY_STEPS[event.key] ?? ends[event.key];
      if (!by || event.ctrlKey || event.metaKey || event.altKey) { return; }
      event.preventDefault();
      move(k, by);
    }, {signal});
  };
  // A line's legs, with a border that is dragged behind each but the last.
  const lay = (which, begins) => {
    name = which;
    line = model.lines[which];
    seconds = [...begins];
    const titles = line.legs.map((leg) => `${leg.from} \u2013 ${leg.to}`);
    parts = line.legs.map((leg, k) => ({
      share: make("div", {class: "share", title: titles[k]}, make("b"), make("span", {}, titles[k])),
      fill: make("i", {style: "background: var(--rj-accent)"}), value: make("span"), own: make("span"),
      border: k + 1 < line.legs.length
        ? make("div", {class: "border", role: "slider", tabindex: "0", "aria-label": `Seconds before ${leg.to}`}) : null,
    }));
    parts.forEach(({border}, k) => border && held(border, k));
    split.replaceChildren(...parts.map(({share}) => share), ...parts.flatMap(({border}) => border ?? []));
    legs.replaceChildren(...line.legs.flatMap((leg, k) => [
      make("span", {}, titles[k], make("small", {}, ` ${figures_of(leg.length_m / 1000, 2)} km, `, parts[k].own, " kWh")),
      make("div", {}, parts[k].fill), parts[k].value,
    ]));
    steps.replaceChildren(...line.legs.slice(0, -1).flatMap((leg, k) => [
      make("span", {}, `Arrive at ${leg.to}`), button("1 s earlier", () => move(k, -1)), button("1 s later", () => move(k, 1)),
    ]));
    result.hidden = true;
    reveal.disabled = true;
    told.textContent = "Drag a border between two legs, or press its arrow keys.";
    show();
  };
  const reveal = button("Show the best sharing", () => {
    asked = true;
    reveal.disabled = true;
    told.textContent = "The best sharing is being computed.";
    model.send_msg({what: "done", sharing: text()});
  }, "main");

  const judge = () => {
    asked = false;
    const verdict = model.verdict, more = verdict.kwh - verdict.bound_kwh;
    told.textContent = "";
    const outcome = make("h2", {class: "outcome", tabindex: "-1"},
      `You need ${figures_of(verdict.kwh, 2)} kWh; no sharing needs less than ${figures_of(verdict.bound_kwh, 2)}.`);
    const words = make("p", {}, make("span", {class: verdict.proven ? "proven" : ""}, verdict.proven ? "\u2713 proven" : "not proven"),
      ` \u00b7 ${figures_of(more, 3)} kWh above the bound (${with_sign((100 * more) / verdict.bound_kwh, 2)} %). In the best sharing one more ` +
      `second saves ${figures_of(verdict.price_wh_s, 0)} Wh on every leg: nothing is won by moving it.`);
    const best = make("p", {}, `Best, as the dashed borders: ${verdict.best_s.map((one) => `${figures_of(one, 1)} s`).join(", ")}. `, make("b", {}, verdict.worth));
    let before = 0;
    for (const one of verdict.best_s.slice(0, -1)) {
      before += one;
      split.append(make("i", {class: "best", style: `left: ${(100 * before) / line.slack_s}%`}));
    }
    result.replaceChildren(outcome, words, make("ul", {}, ...verdict.sentences.map((one) => make("li", {}, one))), best,
      make("div", {class: "row"},
        button("Change it", () => { result.hidden = true; parts[0].border.focus(); }),
        button(WORDS[NEXT[name]], () => {
          lay(NEXT[name], equal_share(model.lines[NEXT[name]]));
          parts[0].border.focus();
        }),
        ...link_button(button, "Copy link", "learn.shared"),
        button("Open in the workbench", () => model.send_msg({what: "open", sharing: text()}), "main")));
    result.hidden = false;
    outcome.focus();
  };

  root.append(make("h2", {}, "2. Share out the slack: which leg should get the spare minute?"),
    make("p", {}, "Three legs, and 60 s more than the train needs at least. On each leg it uses its seconds as well as can be. " +
      "Give seconds to one leg and take them from the next: which sharing needs the least energy?"),
    told, split, steps, make("div", {class: "stage"},
      make("div", {}, make("h3", {}, "One more second would save, Wh"), legs),
      make("div", {class: "clocks"}, make("div", {}, "Whole line", total, against))),
    make("div", {class: "row"}, reveal), result);
  told.textContent = "Opening";
  reveal.disabled = true;
  const prepare = () => {
    if (line || !model.begun.line || !model.lines[model.begun.line]) { return; }
    lay(model.begun.line, model.begun.seconds);
    if (model.begun.linked) { come_into_sight(root); }
  };
  redraw_on(model, ["lines", "begun"], prepare);
  redraw_on(model, ["verdict"], () => { if (model.verdict.line && asked) { judge(); } });
  redraw_on(model, ["refusals"], () => { if (asked) { asked = false; reveal.disabled = false; told.textContent = ""; } });
  prepare();
  return root;
}
