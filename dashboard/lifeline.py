"""The page's ties to its address, its keys, dropped files, the clipboard, and the server.

The browser's half shows at once when the server is gone, and opens the page's address anew when it answers.
"""

from collections.abc import Callable
from typing import Any

import param
from panel.custom import JSComponent

from railjoule.dashboard.models.dropped import LARGEST_REPORT_BYTES, LARGEST_SCENARIO_BYTES

ESM = r"""
const WORDS = {
  lost: "The connection to the server is lost. Your settings are kept in this page.",
  starting: "The server is starting. Your settings are kept in this page.",
};
const WAIT_S = [1, 2, 4, 8, 15], ANSWER_WITHIN_MS = 20000, LEAVING_MS = 100;

const hold_the_line = (document_of_bokeh) => {
  let leaving = false, banner = null, tries = 0, timer = null;
  const part = (tag) => banner.appendChild(document.createElement(tag));
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
    banner = document.createElement("div");
    banner.className = "rj-lost";
    const words = part("span"), left = part("span"), again = part("button");
    words.setAttribute("role", "alert");
    left.setAttribute("aria-hidden", "true");
    again.type = "button";
    again.textContent = "Try now";
    again.addEventListener("click", ask);
    for (const child of document.body.children) { child.inert = true; }
    document.body.prepend(banner);
    document.documentElement.classList.add("rj-gone");
    words.textContent = WORDS.lost;
    wait(WAIT_S[0]);
  }, LEAVING_MS);
  window.addEventListener("pagehide", () => { leaving = true; });
  window.addEventListener("pageshow", (event) => { if (event.persisted) { location.reload(); } });
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

const copy = async (text) => {
  try { await navigator.clipboard.writeText(text); return true; } catch { /* only safe addresses have a clipboard */ }
  const area = document.createElement("textarea");
  area.value = text;
  document.body.append(area);
  area.select();
  const copied = document.execCommand("copy");
  area.remove();
  return copied;
};
const save = (name, text) => {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], {type: "application/toml"}));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
};

export function render({model, view}) {
  const show = () => {
    if (model.address !== location.search + location.hash) {
      history.replaceState(history.state, "", location.pathname + model.address);
    }
  };
  const open = () => {
    if (!/^#v=/.test(location.hash)) { return; }
    model.send_msg({kind: "open", text: location.hash});
    // the state may be there already: then nothing else would take the fragment away
    show();
  };
  model.on("started", () => { if (/^#v=/.test(location.hash)) { open(); } else { show(); } });
  model.on("address", show);
  model.on("msg:custom", async (event) => {
    const {kind, name, text} = event.data ?? event;
    if (kind === "save") { save(name, text); }
    if (kind === "copy") { model.send_msg({kind: "copied", done: await copy(text)}); }
    if (kind === "copy_link") { model.send_msg({kind: "copied", done: await copy(location.href)}); }
  });

  const veil = document.createElement("div");
  veil.className = "rj-drop";
  veil.textContent = "Drop a scenario file or a report to open it";
  const holds_files = (event) => [...(event.dataTransfer?.types ?? [])].includes("Files");
  const read = async (file) => {
    const largest = /\.html?$/i.test(file.name) ? model.largest_report_bytes : model.largest_scenario_bytes;
    if (file.size > largest) { model.send_msg({kind: "too_large", name: file.name}); return; }
    try {
      const text = new TextDecoder("utf-8", {fatal: true}).decode(await file.arrayBuffer());
      model.send_msg({kind: "drop", name: file.name, text});
    } catch { model.send_msg({kind: "no_text", name: file.name}); }
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
      read(event.dataTransfer.files[0]);
    },
  };
  for (const [name, listener] of Object.entries(listeners)) { window.addEventListener(name, listener); }
  model.on("remove", () => {
    for (const [name, listener] of Object.entries(listeners)) { window.removeEventListener(name, listener); }
  });
  hold_the_line(view.model.document);
  return document.createElement("span");
}
"""


class Lifeline(JSComponent):
    """The page's ties to its browser's address, keys, files and clipboard.

    What the browser reports is heard by kind: `open` (a fragment with a state), `undo`, `redo`, `drop` (a file),
    `too_large` and `no_text` (files that cannot be read), `copied`.
    """

    address = param.String(default="", doc="Query or fragment that holds the page's state.")
    started = param.Boolean(default=False, doc="Whether the page has loaded.")
    largest_scenario_bytes = param.Integer(default=LARGEST_SCENARIO_BYTES, doc="Largest scenario file to be dropped.")
    largest_report_bytes = param.Integer(default=LARGEST_REPORT_BYTES, doc="Largest report to be dropped.")

    _esm = ESM

    def __init__(self, **params: object) -> None:
        super().__init__(**params)
        self._listeners: dict[str, Callable[[dict[str, Any]], None]] = {}

    def listen(self, kind: str, callback: Callable[[dict[str, Any]], None]) -> None:
        """Call back with each message of a kind."""
        self._listeners[kind] = callback

    def copy(self, text: str) -> None:
        """Put a text on the clipboard."""
        self._send_msg({"kind": "copy", "text": text})

    def copy_link(self) -> None:
        """Put the page's address on the clipboard."""
        self._send_msg({"kind": "copy_link"})

    def save(self, name: str, text: str) -> None:
        """Let the browser save a text as a file."""
        self._send_msg({"kind": "save", "name": name, "text": text})

    def _handle_msg(self, data: Any) -> None:
        listener = self._listeners.get(str(data.get("kind"))) if isinstance(data, dict) else None
        if listener is not None:
            listener(data)
