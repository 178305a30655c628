// Runs in the head, before anything is painted: the colours of the page, and a sentence if it does not open.
(() => {
  "use strict";
  const LOOK_MS = 200, PATIENCE_MS = 15000, FULL = 503;
  const root = document.documentElement, system = window.matchMedia("(prefers-color-scheme: dark)");
  const state = location.hash.startsWith("#v=") ? location.hash.slice(1) : location.search;
  const chosen = new URLSearchParams(state).get("colours");
  root.classList.toggle("rj-dark", chosen === "dark" || (chosen !== "light" && system.matches));
  // the server cannot see what the system asks for: it finds it in the request for the page
  const cookie = `railjoule_dark=${+system.matches}`, is_known = () => document.cookie.includes(cookie);
  const was_known = is_known() || !system.matches;
  const note = () => { document.cookie = `railjoule_dark=${+system.matches}; path=/; max-age=31536000; samesite=lax`; };
  system.addEventListener("change", note);
  note();
  if (!was_known && is_known()) { location.reload(); }

  // the library shows nowhere that the connection has failed
  const look = async () => {
    const sketch = document.getElementById("rj-first");
    if (!sketch && document.readyState === "complete") { return; }
    const is_lost = typeof Bokeh === "undefined" ? performance.now() > PATIENCE_MS : typeof _wsError !== "undefined" && _wsError;
    if (!sketch || !is_lost) { setTimeout(look, LOOK_MS); return; }
    const status = await fetch(location.href, {cache: "no-store"}).then((answer) => answer.status, () => 0);
    if (status === FULL) { location.reload(); }
    sketch.querySelector("p").textContent = status === 200
      ? "This page could not be opened; the server\u2019s log may contain the reason. Reload it to try again."
      : "The server does not answer. Reload this page to try again.";
  };
  look();
  const deep = (selector, within = document) => [...within.querySelectorAll("*")].reduce(
    (found, {shadowRoot}) => shadowRoot ? found.concat(deep(selector, shadowRoot)) : found,
    [...within.querySelectorAll(selector)]);
  // `components` draw what a page has many of, by the names of their modules
  window.railjoule = {components: {}, deep};
})();
