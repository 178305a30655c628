// Import: the part of the line that is wanted, and what can be taken into the scenario.

import {focused, redraw_on, make} from "./dom.js";

export function render({model}) {
  const root = make("div", {class: "take"});
  const field = (label, value, key, note, act) => {
    const input = make("input", {type: "text", "aria-label": label, "data-key": key, spellcheck: "false",
      autocomplete: "off", maxlength: "40"});
    input.value = value;
    if (act) { input.addEventListener("change", () => act(input.value)); }
    return [make("label", {class: "choice"}, make("span", {}, label), input, ...(note ? [make("span", {class: "muted small"}, note)] : [])), input];
  };
  const stretch_of = () => {
    const send = (key, value) => model.send_msg({what: "stretch", key, value});
    const [begin] = field("From", model.stretch.begin, "begin", "", (text) => send("begin", text));
    const [end] = field("To", model.stretch.end, "end", "", (text) => send("end", text));
    const select = make("select", {"aria-label": "Direction", "data-key": "reverse"},
      ...[["", "rising chainage"], ["1", "falling chainage"]].map(([value, text]) =>
        make("option", {value, selected: (value === "1") === model.stretch.reverse}, text)));
    select.addEventListener("change", () => send("reverse", select.value));
    return make("div", {class: "choices"}, begin, end,
      make("label", {class: "choice"}, make("span", {}, "Direction"), select),
      make("span", {class: "muted small"}, "From and to as 12+300, 12.3km or metres; empty for all of it."));
  };
  const offer_of = (offer) => {
    if (offer.failure) {
      return make("div", {class: "offer"}, make("b", {}, offer.label), make("p", {class: "refusal", role: "alert"}, offer.failure));
    }
    const [time, input] = field("Travel time, s", offer.time, `time ${offer.what}`, offer.why);
    const button = (text, kind, key, without) => {
      const made = make("button", {type: "button", class: kind, "data-key": key}, text);
      made.addEventListener("click", () => model.send_msg({what: "take", offer: offer.what, time: input.value, without}));
      return made;
    };
    const take = button(offer.label, offer.main ? "filled-button" : "plain-button", offer.what, false);
    const about = make("p", {class: "muted small"}, offer.about);
    if (!offer.waits) {
      input.addEventListener("keydown", (event) => { if (event.key === "Enter") { take.click(); } });
      return make("div", {class: "offer"}, take, time, about);
    }
    take.disabled = true;
    return make("div", {class: "offer"}, take, button(offer.without, "plain-button", `${offer.what} without`, true), time,
      make("p", {class: "refusal", role: "alert"}, offer.waits), about);
  };
  const show = () => {
    const key = focused()?.dataset?.key, had = root.contains(focused());
    root.replaceChildren(...(model.has_stretch ? [stretch_of()] : []), ...model.offers.map(offer_of),
      make("p", {class: "small muted", role: "status"}, model.status),
      ...(model.refusal ? [make("p", {class: "refusal", role: "alert"}, model.refusal)] : []));
    if (had && key) { [...root.querySelectorAll("[data-key]")].find((one) => one.dataset.key === key)?.focus(); }
  };
  redraw_on(model, ["offers", "stretch", "has_stretch", "status", "refusal", "version"], show);
  show();
  return root;
}
