// The page's ties to its address, its keys, dropped files, the clipboard, and the server.

import {life_of, make} from "./dom.js";
import {copy_text, offer} from "./files.js";
import {deep} from "./page.js";

const PIECE = 8192;
const WORDS = {
  lost: "The connection to the server is lost. Changes have no effect until this page is loaded again, which it does by " +
    "itself when the server answers.",
  starting: "The server is starting. Changes have no effect until this page is loaded again, which it does by itself.",
};
const ASK_EVERY_MS = 3000, ANSWER_WITHIN_MS = 20000, LEAVING_MS = 100, STARTING = 503, NOT_FOUND = 404;
const HELD_BACK = ["pointerdown", "mousedown", "touchstart", "click", "keydown", "dragover", "drop"];
const FIELDS = "input, select, textarea", CONTROLS = "button, a[href], [role=button], [role=combobox], [role=menuitem], [role=option], [role=tab]";

const is_line = (element) => element instanceof HTMLTextAreaElement ||
  element instanceof HTMLInputElement && !["range", "checkbox", "radio", "button", "file"].includes(element.type);

// Without a server, a page can only be read. It says so, and is loaded again once the server answers. Panel's own
// `reconnect` asks a server that was restarted for a session that it does not have.
const end = async () => {
  const words = make("div", {class: "rj-lost", role: "alert"}, WORDS.lost);
  document.body.prepend(words);
  document.documentElement.classList.add("rj-gone");
  for (const field of deep(FIELDS)) { field[is_line(field) ? "readOnly" : "disabled"] = true; }
  // a part that is scrolled needs something that the keyboard reaches
  for (const control of deep(CONTROLS)) { control.setAttribute("aria-disabled", "true"); }
  for (const name of HELD_BACK) {
    window.addEventListener(name, (event) => {
      event.stopImmediatePropagation();
      const is_file = event.type.startsWith("dr");
      if (is_file || event.type === "click" && event.composedPath().some((element) => element.matches?.(CONTROLS))) {
        event.preventDefault();
      }
    }, {capture: true, passive: false});
  }
  for (;;) {
    await new Promise((resolve) => setTimeout(resolve, ASK_EVERY_MS));
    try {
      const limit = AbortSignal.timeout(ANSWER_WITHIN_MS);
      const {ok, status} = await fetch(new URL("ready", location.href), {cache: "no-store", signal: limit});
      // a server that runs this page as a script has no such address, but it answers
      if (ok || status === NOT_FOUND) { location.reload(); return; }
      const said = status === STARTING ? WORDS.starting : WORDS.lost;
      if (words.textContent !== said) { words.textContent = said; }
    } catch { /* it does not answer yet */ }
  }
};

const watch_connection = (bokeh_document, signal) => {
  let leaving = false;
  window.addEventListener("pagehide", () => { leaving = true; }, {signal});
  window.addEventListener("pageshow", (event) => { if (event.persisted) { location.reload(); } }, {signal});
  bokeh_document.on_event("connection_lost", () => setTimeout(() => { if (!leaving) { end(); } }, LEAVING_MS));
};

// the field into which something was typed that has not been taken yet: there a step back is one of letters
let typed_into = null;
const field_of = (event) => {
  const target = event.composedPath()[0];
  if (!(target instanceof HTMLElement)) { return null; }
  return is_line(target) || target.isContentEditable ? target : null;
};
const typing = {
  input: (event) => { typed_into = field_of(event); },
  focusin: (event) => { if (typed_into !== event.composedPath()[0]) { typed_into = null; } },
  keyup: (event) => {
    if (event.key === "Enter" && field_of(event) instanceof HTMLInputElement) { typed_into = null; }
  },
};
const way_of = (event) => {
  if (!(event.ctrlKey || event.metaKey) || event.altKey) { return null; }
  const field = field_of(event), key = event.key.toLowerCase();
  if (field && !(field instanceof HTMLInputElement && field !== typed_into)) { return null; }
  if (key === "z") { return event.shiftKey ? "redo" : "undo"; }
  return key === "y" && !event.shiftKey ? "redo" : null;
};

export function render({model, view}) {
  const signal = life_of(model);
  watch_connection(view.model.document, signal);
  const show = () => {
    if (model.address !== location.search + location.hash) {
      history.replaceState(history.state, "", location.pathname + model.address);
    }
  };
  const open = () => {
    if (!location.hash.startsWith("#v=")) { return; }
    model.send_msg({kind: "open", text: location.hash});
    // the state may be there already: then nothing else would take the fragment away
    show();
  };
  model.on("started", () => { if (location.hash.startsWith("#v=")) { open(); } else { show(); } });
  model.on("address", show);
  model.on("msg:custom", async (event) => {
    const {kind, name, text, type} = event.data ?? event;
    if (kind === "save") { offer(text, type, name); }
    if (kind === "copy") { model.send_msg({kind: "copied", done: await copy_text(text)}); }
    if (kind === "copy_link") { model.send_msg({kind: "copied", done: await copy_text(location.href)}); }
  });

  const veil = make("div", {class: "rj-drop"}, "Drop a line, a train, recorded runs, a scenario, a report or a study to open it");
  const holds_files = (event) => [...(event.dataTransfer?.types ?? [])].includes("Files");
  // the server finds out the kind of each file by its name and content
  const send = async (file) => {
    if (file.size > model.largest_bytes) { model.send_msg({kind: "too_large", name: file.name}); return; }
    const bytes = new Uint8Array(await file.arrayBuffer()), pieces = [];
    for (let at = 0; at < bytes.length; at += PIECE) { pieces.push(String.fromCharCode(...bytes.subarray(at, at + PIECE))); }
    model.send_msg({kind: "drop", name: file.name, data: btoa(pieces.join(""))});
  };
  const listeners = {
    ...typing,
    keydown: (event) => {
      const way = way_of(event);
      if (!way) { return; }
      event.preventDefault();
      model.send_msg({kind: way});
    },
    hashchange: open,
    dragover: (event) => {
      if (holds_files(event)) { event.preventDefault(); document.body.append(veil); }
    },
    dragleave: (event) => { if (!event.relatedTarget) { veil.remove(); } },
    drop: (event) => {
      veil.remove();
      if (!holds_files(event) || !event.dataTransfer.files.length) { return; }
      event.preventDefault();
      [...event.dataTransfer.files].forEach(send);
    },
  };
  for (const [name, listener] of Object.entries(listeners)) { window.addEventListener(name, listener, {signal}); }
  return make("span");
}
