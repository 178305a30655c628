// The page's ties to its address, its keys, dropped files, the clipboard, and the server: it shows at once when that is
// gone or does not answer, and opens the page's address anew when it is back.

import {focused, life_of, make} from "./dom.js";
import {copy_text, offer} from "./files.js";

const WORDS = {
  lost: "The connection to the server is lost. You can read and change numbers; they are kept in this page.",
  starting: "The server is starting. You can read and change numbers; they are kept in this page.",
  silent: "The server does not answer. You can go on; what you change is kept in this page.",
  back: "The server is back. This page opens anew once you have left the field.",
};
const TABLE = /\.(csv|tsv|txt|xlsx)$/i, STUDY = /\.nc$/i, PIECE = 8192;
const WAIT_S = [1, 2, 4, 8, 15], ANSWER_WITHIN_MS = 20000, LEAVING_MS = 100;
// a question that is older is shown to wait, and one that is much older has perhaps no answer
const WAITING_MS = 1000, SILENT_MS = 5000, LOOK_MS = 200, CATCHES_UP_MS = 1500;
// what only a server can do; numbers are changed without one, and what explains a word is there
const PRESSED = `button:not(.info), a[href], select, [role=button], [role=combobox], [role=option], [role=menuitem],
  [role=tab], [role=switch], input[type=checkbox], input[type=radio], input[type=file]`;

const make_banner = (again) => {
  const words = make("span", {role: "alert"}), left = make("span", {"aria-hidden": "true"});
  const button = make("button", {type: "button"}, "Try now");
  button.addEventListener("click", again);
  const element = make("div", {class: "rj-lost"}, words, left, button);
  document.body.prepend(element);
  const say = (text) => { if (words.textContent !== text) { words.textContent = text; } };
  return {element, say, count: (text) => { left.textContent = text; }};
};

const hold_the_line = (document_of_bokeh, signal) => {
  const root = document.documentElement, {wire} = window.railjoule;
  let leaving = false, gone = false, banner = null, note = null, tries = 0, timer = null;
  const reopen = () => {
    if (!is_typing()) { location.reload(); return; }
    banner.say(WORDS.back);
    banner.count("");
    // what was typed is a change once the field is left, of which nobody hears outside its shadow root
    timer = setTimeout(reopen, LOOK_MS);
  };
  const show = () => {
    banner ??= make_banner(ask);
    banner.say(gone ? WORDS.lost : WORDS.silent);
  };
  const hide = () => {
    clearTimeout(timer);
    banner?.element.remove();
    banner = null;
    tries = 0;
  };
  const ask = async () => {
    clearTimeout(timer);
    banner?.count("Trying now.");
    try {
      const limit = AbortSignal.timeout(ANSWER_WITHIN_MS);
      const answer = await fetch(new URL("health", location.href), {cache: "no-store", signal: limit});
      // a server that answers others takes up this page's line too, unless that is broken
      if (!gone) { await new Promise((resolve) => setTimeout(resolve, CATCHES_UP_MS)); }
      if (!banner) { return; }
      // a server that runs this page as a script has no health check, but it answers
      if (answer.ok || answer.status === 404) { reopen(); return; }
      banner.say(answer.status === 503 ? WORDS.starting : WORDS.lost);
    } catch { if (banner) { show(); } }
    // each try that fails leaves an error in the browser's console: they become rare
    if (banner) { wait(WAIT_S[Math.min(tries++, WAIT_S.length - 1)]); }
  };
  const wait = (seconds) => {
    if (seconds <= 0) { ask(); return; }
    banner.count(`Trying again in ${seconds} s.`);
    timer = setTimeout(wait, 1000, seconds - 1);
  };
  const look = () => {
    const late = gone || leaving ? 0 : wire.waits_ms();
    root.classList.toggle("rj-waiting", late > WAITING_MS);
    if (late > WAITING_MS && !note) {
      note = make("div", {class: "rj-wait", role: "status"});
      document.body.append(note);
      // a region that comes with its words is not read out
      note.textContent = "Waiting for the server";
    } else if (late <= WAITING_MS && note) { note.remove(); note = null; }
    if (late > SILENT_MS && !banner) {
      show();
      wait(WAIT_S.at(-1));
    } else if (late <= SILENT_MS && banner && !gone) { hide(); }
  };
  const looking = setInterval(look, LOOK_MS);
  signal.addEventListener("abort", () => clearInterval(looking));
  const lost = () => setTimeout(() => {
    if (leaving || gone) { return; }
    gone = true;
    wire.end();
    hide();
    look();
    show();
    root.classList.add("rj-gone");
    const hold_back = (event) => {
      const path = event.composedPath();
      if (path.includes(banner.element) || !path.some((element) => element.matches?.(PRESSED))) { return; }
      event.preventDefault();
      event.stopImmediatePropagation();
    };
    for (const name of ["click", "mousedown", "pointerdown"]) {
      window.addEventListener(name, hold_back, {capture: true, signal});
    }
    wait(WAIT_S[0]);
  }, LEAVING_MS);
  window.addEventListener("pagehide", () => { leaving = true; }, {signal});
  window.addEventListener("pageshow", (event) => { if (event.persisted) { location.reload(); } }, {signal});
  document_of_bokeh.on_event("connection_lost", lost);
  return () => gone;
};

// the field into which something was typed that has not been taken yet: there a step back is one of letters
let typed_into = null;
const field_of = (event) => {
  const target = event.composedPath()[0];
  if (!(target instanceof HTMLElement)) { return null; }
  const is_line = target instanceof HTMLInputElement && !["range", "checkbox", "radio", "button"].includes(target.type);
  return is_line || target instanceof HTMLTextAreaElement || target.isContentEditable ? target : null;
};
const is_typing = () => typed_into !== null && focused() === typed_into;
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
  const signal = life_of(model), {unsent} = window.railjoule, is_gone = hold_the_line(view.model.document, signal);
  const show = () => {
    if (model.address !== location.search + location.hash) {
      history.replaceState(history.state, "", location.pathname + model.address);
    }
    unsent.noted();
  };
  const open = () => {
    if (!location.hash.startsWith("#v=")) { return; }
    unsent.drop();
    model.send_msg({kind: "open", text: location.hash});
    // the state may be there already: then nothing else would take the fragment away
    show();
  };
  model.on("started", () => {
    const changes = unsent.take();
    if (location.hash.startsWith("#v=")) { open(); } else { show(); }
    if (changes) { model.send_msg({kind: "unsent", changes}); }
  });
  model.on("address", show);
  model.on("msg:custom", async (event) => {
    const {kind, name, text, type} = event.data ?? event;
    if (kind === "save") { offer(text, type, name); }
    if (kind === "copy") { model.send_msg({kind: "copied", done: await copy_text(text)}); }
    if (kind === "copy_link") { model.send_msg({kind: "copied", done: await copy_text(location.href)}); }
  });

  const veil = make("div", {class: "rj-drop"}, "Drop a scenario, a report, a study or the file of a measured run to open it");
  const holds_files = (event) => [...(event.dataTransfer?.types ?? [])].includes("Files");
  const read = async (file) => {
    const largest = /\.html?$/i.test(file.name) ? model.largest_report_bytes : model.largest_scenario_bytes;
    if (file.size > largest) { model.send_msg({kind: "too_large", name: file.name}); return; }
    try {
      const text = new TextDecoder("utf-8", {fatal: true}).decode(await file.arrayBuffer());
      model.send_msg({kind: "drop", name: file.name, text});
    } catch { model.send_msg({kind: "no_text", name: file.name}); }
  };
  // workbooks and studies are no text: they go as they are, all that are dropped
  const read_bytes = async (file) => {
    const kind = STUDY.test(file.name) ? "study" : "table";
    if (file.size > model.largest_table_bytes) { model.send_msg({kind: `large_${kind}`, name: file.name}); return; }
    const bytes = new Uint8Array(await file.arrayBuffer()), pieces = [];
    for (let at = 0; at < bytes.length; at += PIECE) { pieces.push(String.fromCharCode(...bytes.subarray(at, at + PIECE))); }
    model.send_msg({kind, name: file.name, data: btoa(pieces.join(""))});
  };
  const listeners = {
    ...typing,
    keydown: (event) => {
      const way = way_of(event);
      if (!way) { return; }
      event.preventDefault();
      if (is_gone()) { return; }
      unsent.drop();
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
      if (is_gone()) { return; }
      const files = [...event.dataTransfer.files];
      const binary = files.filter((file) => TABLE.test(file.name) || STUDY.test(file.name));
      if (binary.length) { binary.forEach(read_bytes); } else { read(files[0]); }
    },
  };
  for (const [name, listener] of Object.entries(listeners)) { window.addEventListener(name, listener, {signal}); }
  return make("span");
}
