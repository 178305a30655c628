// What is on its way to the server: since when it is unanswered, and which of it a reload would lose.
(() => {
  "use strict";
  const LONGEST_HEAD = 1000, KEY = "railjoule.unsent", NOTED_AFTER_MS = 250, FORGOTTEN_AFTER_MS = 2000;
  // the library sends a head before each of its messages, and the server names it in its answer
  const asked = new Map(), heard = new WeakSet(), {send} = WebSocket.prototype;
  const head_of = (data, name) => {
    if (typeof data !== "string" || data.length > LONGEST_HEAD || !data.startsWith("{") || !data.includes(`"${name}"`)) {
      return null;
    }
    try { return JSON.parse(data)[name] ?? null; } catch { return null; }
  };
  const hear = ({data}) => { asked.delete(head_of(data, "reqid")); };
  WebSocket.prototype.send = function (data) {
    if (!heard.has(this)) {
      heard.add(this);
      this.addEventListener("message", hear);
    }
    const head = head_of(data, "msgid");
    if (head !== null) { asked.set(head, performance.now()); }
    return send.call(this, data);
  };
  const since = () => Math.min(...asked.values());

  // Fields that were changed, by their names in the page's address, and what was typed into the editor, by the keys of
  // its fields and cells, until the server has taken note of them. A page that is opened anew at the same address
  // changes them once more.
  const changes = new Map();
  let gone = false, timer = null;
  const where = () => location.search + location.hash;
  const write = () => {
    // a browser may keep nothing: then a change is lost with the server, as the page can do no more
    try {
      if (!changes.size) { sessionStorage.removeItem(KEY); return; }
      const values = Object.fromEntries([...changes].map(([name, {text}]) => [name, text]));
      sessionStorage.setItem(KEY, JSON.stringify({address: where(), values}));
    } catch { /* as above */ }
  };
  // lets go of what the server has had for a while
  const forget = (after_ms) => {
    if (gone) { return; }
    const sent = Math.min(since(), performance.now()) - after_ms;
    for (const [name, {at}] of changes) { if (at < sent) { changes.delete(name); } }
    write();
    clearTimeout(timer);
    if (changes.size) { timer = setTimeout(forget, FORGOTTEN_AFTER_MS / 4, FORGOTTEN_AFTER_MS); }
  };
  const keep = (name, text) => {
    if (!name) { return; }
    changes.set(name, {text, at: performance.now()});
    write();
    clearTimeout(timer);
    timer = setTimeout(forget, FORGOTTEN_AFTER_MS, FORGOTTEN_AFTER_MS);
  };
  const wire = {
    // for how long the oldest question has had no answer
    waits_ms: () => asked.size ? performance.now() - since() : 0,
    // the connection has ended: nothing is answered any more, and nothing forgotten
    end: () => { gone = true; asked.clear(); },
  };
  const unsent = {
    keep,
    // the address is another one, which holds what was changed before
    noted: () => forget(NOTED_AFTER_MS),
    // a step back, or another state altogether
    drop: () => { changes.clear(); write(); },
    // what was on its way when this address was left; null for nothing
    take: () => {
      let kept = null;
      try {
        kept = JSON.parse(sessionStorage.getItem(KEY));
        sessionStorage.removeItem(KEY);
      } catch { return null; }
      if (kept?.address !== where()) { return null; }
      for (const [name, text] of Object.entries(kept.values)) { keep(name, text); }
      return kept.values;
    },
  };
  Object.assign(window.railjoule, {wire, unsent});
})();
