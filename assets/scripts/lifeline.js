// The page's ties to its address, its keys, dropped files, the clipboard, and the server: it shows at once when that is
// gone, and opens the page's address anew when it answers.

import {life_of, make} from "./dom.js";
import {copy_text, offer} from "./files.js";

const WORDS = {
  lost: "The connection to the server is lost. Your settings are kept in this page.",
  starting: "The server is starting. Your settings are kept in this page.",
};
const TABLE = /\.(csv|tsv|txt|xlsx)$/i, PIECE = 8192;
const WAIT_S = [1, 2, 4, 8, 15], ANSWER_WITHIN_MS = 20000, LEAVING_MS = 100;

const hold_the_line = (document_of_bokeh, signal) => {
  let leaving = false, banner = null, tries = 0, timer = null;
  const ask = async () => {
    clearTimeout(timer);
    const [words, left] = banner.children;
    left.textContent = "Trying now.";
    try {
      const limit = AbortSignal.timeout(ANSWER_WITHIN_MS);
      const answer = await fetch(new URL("health", location.href), {cache: "no-store", signal: limit});
      // a server that runs this page as a script has no health check, but it answers
      if (answer.ok || answer.status === 404) { location.reload(); return; }
      if (answer.status === 503 && words.textContent !== WORDS.starting) { words.textContent = WORDS.starting; }
    } catch { if (words.textContent !== WORDS.lost) { words.textContent = WORDS.lost; } }
    // each try that fails leaves an error in the browser's console: they become rare
    wait(WAIT_S[Math.min(tries++, WAIT_S.length - 1)]);
  };
  const wait = (seconds) => {
    if (seconds <= 0) { ask(); return; }
    banner.children[1].textContent = `Trying again in ${seconds} s.`;
    timer = setTimeout(wait, 1000, seconds - 1);
  };
  const lost = () => setTimeout(() => {
    if (leaving || banner) { return; }
    const words = make("span", {role: "alert"}), left = make("span", {"aria-hidden": "true"});
    const again = make("button", {type: "button"}, "Try now");
    again.addEventListener("click", ask);
    banner = make("div", {class: "rj-lost"}, words, left, again);
    for (const child of document.body.children) { child.inert = true; }
    document.body.prepend(banner);
    document.documentElement.classList.add("rj-gone");
    words.textContent = WORDS.lost;
    wait(WAIT_S[0]);
  }, LEAVING_MS);
  window.addEventListener("pagehide", () => { leaving = true; }, {signal});
  window.addEventListener("pageshow", (event) => { if (event.persisted) { location.reload(); } }, {signal});
  document_of_bokeh.on_event("connection_lost", lost);
};

// the field into which something was typed that has not been taken yet: there a step back is one of letters
let typed_into = null;
const field_of = (event) => {
  const target = event.composedPath()[0];
  if (!(target instanceof HTMLElement)) { return null; }
  const is_line = target instanceof HTMLInputElement && !["range", "checkbox", "radio", "button"].includes(target.type);
  return is_line || target instanceof HTMLTextAreaElement || target.isContentEditable ? target : null;
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

  const veil = make("div", {class: "rj-drop"}, "Drop a scenario, a report or the file of a measured run to open it");
  const holds_files = (event) => [...(event.dataTransfer?.types ?? [])].includes("Files");
  const read = async (file) => {
    const largest = /\.html?$/i.test(file.name) ? model.largest_report_bytes : model.largest_scenario_bytes;
    if (file.size > largest) { model.send_msg({kind: "too_large", name: file.name}); return; }
    try {
      const text = new TextDecoder("utf-8", {fatal: true}).decode(await file.arrayBuffer());
      model.send_msg({kind: "drop", name: file.name, text});
    } catch { model.send_msg({kind: "no_text", name: file.name}); }
  };
  // a workbook is no text: tables go as they are, all that are dropped
  const read_table = async (file) => {
    if (file.size > model.largest_table_bytes) { model.send_msg({kind: "large_table", name: file.name}); return; }
    const bytes = new Uint8Array(await file.arrayBuffer()), pieces = [];
    for (let at = 0; at < bytes.length; at += PIECE) { pieces.push(String.fromCharCode(...bytes.subarray(at, at + PIECE))); }
    model.send_msg({kind: "table", name: file.name, data: btoa(pieces.join(""))});
  };
  const listeners = {
    ...typing,
    keydown: (event) => {
      const way = way_of(event);
      if (way) { event.preventDefault(); model.send_msg({kind: way}); }
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
      const files = [...event.dataTransfer.files], tables = files.filter((file) => TABLE.test(file.name));
      if (tables.length) { tables.forEach(read_table); } else { read(files[0]); }
    },
  };
  for (const [name, listener] of Object.entries(listeners)) { window.addEventListener(name, listener, {signal}); }
  hold_the_line(view.model.document, signal);
  return make("span");
}
