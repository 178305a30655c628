// Import: files that are dropped or chosen, a card for each with its first rows and what its columns mean.

import {focused, redraw_on, life_of, make} from "./dom.js";

const IS_SCENARIO = /\.(toml|html?)$/i;
const encoded = (file) => new Promise((resolve, reject) => {
  const reader = new FileReader();
  reader.addEventListener("load", () => resolve(String(reader.result).split(",")[1] ?? ""));
  reader.addEventListener("error", () => reject(reader.error));
  reader.readAsDataURL(file);
});
const menu = (label, options, value, key, change) => {
  const select = make("select", {"aria-label": label, "data-key": key},
    ...options.map(([one, text]) => make("option", {value: one, selected: one === value}, text)));
  select.addEventListener("change", () => change(select.value));
  return select;
};

export function render({model}) {
  const life = life_of(model), root = make("div", {class: "brought"});
  const chooser = make("input", {type: "file", multiple: true, accept: model.accept, hidden: true,
    "aria-label": "Files of a line or a train"});
  const own_error = make("p", {class: "refusal", role: "alert", hidden: true});
  const bring = async (files) => {
    own_error.hidden = true;
    for (const file of files) {
      if (file.size > model.max_bytes) { model.send_msg({what: "too_large", name: file.name}); continue; }
      try {
        model.send_msg({what: "add", name: file.name, content: await encoded(file)});
      } catch {
        own_error.textContent = `${file.name}: the browser could not read it; choose it again.`;
        own_error.hidden = false;
      }
    }
  };
  chooser.addEventListener("change", async () => { await bring([...chooser.files]); chooser.value = ""; });
  const button = (text, key, act, kind = "text-button") => {
    const made = make("button", {type: "button", class: kind, "data-key": key}, text);
    made.addEventListener("click", act);
    return made;
  };
  const zone = make("div", {class: "drop-zone"}, make("p", {}, "Drop files here, or"),
    button("Choose files", "choose", () => chooser.click(), "filled-button"),
    button("Load the example", "example", () => model.send_msg({what: "example"})), chooser,
    make("p", {class: "muted small"}, model.formats));
  const error = make("p", {class: "refusal", role: "alert", hidden: true}), body = make("div");
  root.append(zone, own_error, error, body);

  const in_sight = () => root.getClientRects().length > 0;
  const holds_files = (event) => [...(event.dataTransfer?.types ?? [])].includes("Files");
  // first of all who listen: elsewhere a dropped file is a scenario
  const listeners = {
    dragover: (event) => {
      if (!in_sight() || !holds_files(event)) { return; }
      event.preventDefault();
      event.stopImmediatePropagation();
      zone.classList.add("over");
    },
    dragleave: (event) => { if (!event.relatedTarget) { zone.classList.remove("over"); } },
    drop: (event) => {
      zone.classList.remove("over");
      const files = [...(event.dataTransfer?.files ?? [])];
      if (!in_sight() || !files.length || files.every((file) => IS_SCENARIO.test(file.name))) { return; }
      event.preventDefault();
      event.stopImmediatePropagation();
      bring(files);
    },
  };
  for (const [name, listener] of Object.entries(listeners)) {
    window.addEventListener(name, listener, {signal: life, capture: true});
  }

  const sentences = (title, list, kind) => list.length ? [make("div", {class: kind}, make("h4", {}, title),
    make("ul", {}, ...list.map((one) => make("li", {}, one))))] : [];
  const question_of = (card, question, index) => make("div", {class: "question", role: "group", "aria-label": "Question"},
    make("p", {}, question.sentence),
    button(question.use, `use ${card.number} ${index}`,
      () => model.send_msg({what: "say", number: card.number, key: question.key, value: question.value}), "filled-button"),
    button(question.keep, `keep ${card.number} ${index}`,
      () => model.send_msg({what: "say", number: card.number, key: question.key, value: question.kept}), "plain-button"));
  const rows_of = (card) => make("div", {class: "scroll", tabindex: "0", role: "region",
    "aria-label": `First rows of ${card.name}`}, make("table", {},
    make("thead", {}, make("tr", {}, ...card.header.map((name, index) =>
      make("th", {scope: "col", class: card.used[index] ? "used" : ""}, name,
        make("span", {class: "role"}, card.used[index] || "not used"))))),
    make("tbody", {}, ...card.rows.map((row) => make("tr", {}, ...row.map((cell) => make("td", {}, cell)))))));
  const choice_of = (card, choice) => make("label", {class: choice.value === "" && choice.needed ? "choice needed" : "choice"},
    make("span", {}, choice.label),
    menu(`${choice.label}: ${card.name}`, choice.options, choice.value, `say ${card.number} ${choice.key}`,
      (value) => model.send_msg({what: "say", number: card.number, key: choice.key, value})));
  const card_of = (card) => {
    const kinds = card.kinds.length ? menu(`What ${card.name} is`, card.kinds, card.kind, `kind ${card.number}`,
      (value) => model.send_msg({what: "kind", number: card.number, value})) : make("b", {}, card.kind_words);
    const remove = button("Remove", `remove ${card.number}`, () => model.send_msg({what: "remove", number: card.number}));
    remove.setAttribute("aria-label", `Remove ${card.name}`);
    return make("section", {class: "file-card", "aria-label": card.name},
      make("div", {class: "file-head"}, make("h3", {}, card.name), kinds, make("span", {class: "muted small"}, card.about),
        remove),
      ...(card.failure ? [make("p", {class: "refusal", role: "alert"}, card.failure)] : []),
      ...(card.header.length ? [rows_of(card)] : []),
      ...(card.choices.length ? [make("div", {class: "choices"}, ...card.choices.map((one) => choice_of(card, one)))] : []),
      ...card.questions.map((one, index) => question_of(card, one, index)),
      make("div", {class: "told-of-file"}, ...sentences("Noticed", card.findings, "noticed"),
        ...sentences("Not used", card.unused, "unused")));
  };
  const show = () => {
    const key = focused()?.dataset?.key;
    error.textContent = model.refusal;
    error.hidden = !model.refusal;
    body.replaceChildren(...model.cards.map(card_of));
    // what had the focus has been drawn anew; of what has gone, the way in is next
    if (key && root.isConnected && !root.contains(focused())) {
      ([...root.querySelectorAll("[data-key]")].find((one) => one.dataset.key === key)
        ?? root.querySelector("[data-key=choose]")).focus();
    }
  };
  redraw_on(model, ["cards", "refusal", "version"], show);
  show();
  return root;
}
