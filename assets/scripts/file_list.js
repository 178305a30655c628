// My files: each with what it is and when it was changed; opened, renamed, duplicated, deleted and taken back.

import {redraw_on, make} from "./dom.js";

const LARGEST_FILE = 2e6;
const DATE = new Intl.DateTimeFormat("en-GB", {dateStyle: "medium", timeStyle: "short"});
const key_of = (file) => `${file.kind}/${file.name}`;

export function render({model}) {
  const root = make("div", {class: "own-files"});
  let renaming = null, wanted = null, typed = "";
  const send = (what, file, more = {}) =>
    model.send_msg({what, ...(file ? {kind: file.kind, name: file.name} : {}), ...more});
  const text_button = (text, name, act) => {
    const button = make("button", {type: "button", class: "text-button", "aria-label": name}, text);
    button.addEventListener("click", act);
    return button;
  };

  const status = make("p", {class: "told", role: "status"});
  const error = make("p", {class: "refusal", role: "alert", hidden: true});
  const tell = (sentence) => { error.textContent = sentence; error.hidden = !sentence; };
  const chooser = make("input", {type: "file", accept: ".toml,.csv"});
  chooser.addEventListener("change", async () => {
    const [file] = chooser.files;
    if (!file) return;
    if (file.size > LARGEST_FILE) {
      tell(`${file.name}: larger than the 2 MB allowed. Nothing is changed.`);
    } else {
      try {
        const text = new TextDecoder("utf-8", {fatal: true}).decode(await file.arrayBuffer());
        send("add", null, {file: file.name, text});
      } catch { tell(`${file.name}: not UTF-8 text. Nothing is changed.`); }
    }
    chooser.value = "";
  });
  const add = text_button("Add a file", "Add a file to My files", () => chooser.click());
  const note = make("span", {class: "muted"});
  const head = make("div", {class: "own-head"}, make("h2", {}, "My files ", note), add);
  const body = make("div"), left_out = make("div", {class: "muted small"});
  root.append(head, error, status, body, left_out);

  const renamer = (file) => {
    const input = make("input", {type: "text", class: "wide", maxlength: "200", spellcheck: "false", autocomplete: "off",
      "aria-label": `New name of ${file.name}`});
    input.value = typed || file.name;
    input.addEventListener("input", () => { typed = input.value; });
    const end = () => { renaming = null; typed = ""; wanted = [key_of(file), "name"]; show(); };
    const commit = () => {
      typed = input.value;
      if (input.value.trim() === file.name) { end(); return; }
      send("rename", file, {text: input.value});
    };
    input.addEventListener("keydown", (event) => {
      if (event.key === "Enter") { event.preventDefault(); commit(); }
      if (event.key === "Escape") { event.stopPropagation(); end(); }
    });
    return make("div", {class: "renaming"}, input, text_button("Save name", `Save the new name of ${file.name}`, commit),
      text_button("Cancel", `Keep the name ${file.name}`, end));
  };

  const row_of = (file) => {
    const key = key_of(file), date = DATE.format(new Date(1000 * file.changed_s));
    let name = make("span", {class: "name"}, file.name);
    if (file.opens) {
      name = make("button", {type: "button", class: "name", "aria-label": `${file.opens} ${file.name}`, title: file.opens},
        file.name);
      name.addEventListener("click", () => send("open", file));
    }
    name.dataset.place = `${key} name`;
    const marks = [];
    if (file.open) { marks.push(make("span", {class: "muted small"}, "open")); }
    if (file.stale) {
      marks.push(make("span", {class: "stale small"}, "changed in its folder since it was opened"));
    }
    const under = make("span", {class: "under muted small"}, `${file.label}, ${date}`);
    const first = renaming === key ? renamer(file) : make("div", {}, name, " ", ...marks, under);
    const act = (text, what, words) => {
      const button = text_button(text, words, () => {
        if (what === "rename") { renaming = key; typed = ""; wanted = [key, "input"]; show(); return; }
        wanted = what === "delete" ? ["", "undo"] : [key, "name"];
        send(what, file);
      });
      return button;
    };
    return make("tr", {"data-key": key}, make("td", {}, first), make("td", {class: "kind"}, file.label),
      make("td", {class: "date"}, date),
      make("td", {class: "acts"}, act("Rename", "rename", `Rename ${file.name}`),
        act("Duplicate", "duplicate", `Duplicate ${file.name}`), act("Delete", "delete", `Delete ${file.name}`)));
  };

  const focus = (before) => {
    if (!wanted) {
      const again = before && [...root.querySelectorAll("[aria-label]")].find((one) => one.ariaLabel === before);
      again?.focus();
      return;
    }
    const [key, what] = wanted;
    const row = [...root.querySelectorAll("tr[data-key]")].find((one) => one.dataset.key === key);
    const found = what === "undo" ? status.querySelector("button") : row?.querySelector(what === "input" ? "input" : "button.name");
    if (found) { found.focus(); if (what === "input") { found.select(); } wanted = null; }
  };
  const show = () => {
    const {files, deleted, folder, refusal} = model;
    // a list that others have changed is drawn anew under the hand of whoever uses it
    const before = root.getRootNode().activeElement?.ariaLabel;
    if (renaming && !files.some((file) => key_of(file) === renaming)) { renaming = null; typed = ""; }
    note.textContent = folder;
    tell(refusal);
    const undo = text_button("Undo", `Undo deleting ${deleted}`, () => { wanted = null; send("undo"); });
    status.replaceChildren(...(deleted ? [`Deleted ${deleted}. `, undo] : []));
    const cell = (words, name) => make("th", {scope: "col", class: name}, words);
    body.replaceChildren(files.length
      ? make("table", {"aria-label": "My files"},
        make("thead", {}, make("tr", {}, cell("Name", ""), cell("Kind", "kind"), cell("Changed", "date"),
          make("th", {scope: "col", class: "acts"}, make("span", {class: "hidden"}, "Change the file")))),
        make("tbody", {}, ...files.map(row_of)))
      : make("p", {class: "muted"}, "Nothing saved yet. \u201cSave to My files\u201d beside the page saves the scenario, its " +
        "vehicle, its line or the run that is shown; files put into the folder appear here."));
    left_out.replaceChildren(...model.left_out.map(([place, reason]) => make("p", {}, `Not listed: ${place}, ${reason}.`)));
    focus(before);
  };
  redraw_on(model, ["files", "deleted", "folder", "refusal", "left_out"], show);
  show();
  return root;
}
