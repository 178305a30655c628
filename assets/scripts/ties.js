// The page's ties to its address, to the keys of undo, to dropped files, and to the server.

import {deep, make} from "./dom.js";
import {copy_text, offer} from "./files.js";

const PIECE = 8192;
const ASK_EVERY_MS = 3000, ANSWER_WITHIN_MS = 20000, LEAVING_MS = 100, STARTING = 503, NOT_FOUND = 404;
const WORDS = {
  lost: "The connection to the server is lost. Changes have no effect until this page is loaded again, which it does by " +
    "itself when the server answers.",
  starting: "The server is starting. Changes have no effect until this page is loaded again, which it does by itself.",
};
const HELD_BACK = ["pointerdown", "mousedown", "touchstart", "click", "keydown", "beforeinput", "dragover", "drop"];

export const is_line = (element) => element instanceof HTMLTextAreaElement || element?.isContentEditable ||
  element instanceof HTMLInputElement && !["range", "checkbox", "radio", "button", "file"].includes(element.type);

// Without a server, a page can only be read. A banner states that, and the page is loaded again once the server answers. Panel's own
// `reconnect` asks a server that was restarted for a session that it does not have.
const wait_for_server = async () => {
  const words = make("div", {class: "rj-lost", role: "alert"}, WORDS.lost);
  document.body.prepend(words);
  document.documentElement.classList.add("rj-gone");
  for (const field of deep("input, select, textarea")) { field[is_line(field) ? "readOnly" : "disabled"] = true; }
  // a part that is scrolled needs something that the keyboard reaches
  for (const control of deep("button, a[href], [role=button]")) { control.setAttribute("aria-disabled", "true"); }
  for (const name of HELD_BACK) {
    window.addEventListener(name, (event) => {
      event.stopImmediatePropagation();
      if (["click", "beforeinput", "dragover", "drop"].includes(name)) { event.preventDefault(); }
    }, {capture: true, passive: false});
  }
  for (;;) {
    await new Promise((resolve) => setTimeout(resolve, ASK_EVERY_MS));
    try {
      const limit = AbortSignal.timeout(ANSWER_WITHIN_MS);
      const {ok, status} = await fetch(new URL("ready", location.href), {cache: "no-store", signal: limit});
      // a server that runs this page as a script has no such address, but it answers
      if (ok || status === NOT_FOUND) { location.reload(); return; }
      words.textContent = status === STARTING ? WORDS.starting : WORDS.lost;
    } catch { /* it does not answer yet */ }
  }
};

// Sends a file; the server finds out its kind by its name and content.
export const send_file = async (model, file) => {
  if (file.size > model.largest_bytes) { model.send_msg({kind: "too_large", name: file.name}); return; }
  const bytes = new Uint8Array(await file.arrayBuffer()), pieces = [];
  for (let at = 0; at < bytes.length; at += PIECE) { pieces.push(String.fromCharCode(...bytes.subarray(at, at + PIECE))); }
  model.send_msg({kind: "drop", name: file.name, data: btoa(pieces.join(""))});
};

export const tie = (model, bokeh_document, signal) => {
  const on = (name, listener) => window.addEventListener(name, listener, {signal});
  let leaving = false;
  on("pagehide", () => { leaving = true; });
  on("pageshow", (event) => { if (event.persisted) { location.reload(); } });
  bokeh_document.on_event("connection_lost", () => setTimeout(() => { if (!leaving) { wait_for_server(); } }, LEAVING_MS));

  const show = () => {
    if (model.address !== location.search + location.hash) {
      history.replaceState(history.state, "", location.pathname + model.address);
    }
  };
  const open = () => {
    if (location.hash.startsWith("#v=")) { model.send_msg({kind: "open", text: location.hash}); }
    // the state may be there already: then nothing else would take the fragment away
    show();
  };
  model.on("started", open);
  model.on("address", show);
  on("hashchange", open);
  model.on("msg:custom", async (event) => {
    const {kind, name, text, data, type} = event.data ?? event;
    if (kind === "save") { offer(data ? Uint8Array.from(atob(data), (sign) => sign.charCodeAt(0)) : text, type, name); }
    if (kind === "copy") { model.send_msg({kind: "copied", done: await copy_text(text ?? location.href)}); }
  });

  // a step back is one of letters in a field into which something was typed that has not been taken yet
  let typed_into = null;
  on("input", (event) => { [typed_into] = event.composedPath(); });
  on("focusin", (event) => { if (typed_into !== event.composedPath()[0]) { typed_into = null; } });
  on("keyup", (event) => { if (event.key === "Enter") { typed_into = null; } });
  on("keydown", (event) => {
    const [field] = event.composedPath(), key = event.key.toLowerCase();
    if (!(event.ctrlKey || event.metaKey) || event.altKey || !["y", "z"].includes(key)) { return; }
    if (is_line(field) && (field === typed_into || !(field instanceof HTMLInputElement))) { return; }
    event.preventDefault();
    model.send_msg({kind: key === "y" || event.shiftKey ? "redo" : "undo"});
  });

  const veil = make("div", {class: "rj-drop"}, "Drop a line, a train, recorded runs, a scenario, a report or a study to open it");
  const holds_files = (event) => event.dataTransfer?.types.includes("Files");
  on("dragover", (event) => { if (holds_files(event)) { event.preventDefault(); document.body.append(veil); } });
  on("dragleave", (event) => { if (!event.relatedTarget) { veil.remove(); } });
  on("drop", (event) => {
    veil.remove();
    if (!holds_files(event)) { return; }
    event.preventDefault();
    for (const file of event.dataTransfer.files) { send_file(model, file); }
  });
};
