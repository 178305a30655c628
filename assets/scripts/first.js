// Runs in the head, before anything is painted: the colours of the page, and a list of all shadow roots as they come
// to be, so that nobody has to search the whole page for them.
(() => {
  "use strict";
  const root = document.documentElement;
  const system = window.matchMedia("(prefers-color-scheme: dark)");
  const state = location.hash.startsWith("#v=") ? location.hash.slice(1) : location.search;
  const chosen = new URLSearchParams(state).get("colours");
  root.classList.toggle("rj-dark", chosen === "dark" || (chosen !== "light" && system.matches));
  // the server cannot see what the system asks for; it is told for the next page
  const tell = () => { document.cookie = `railjoule_dark=${+system.matches}; path=/; max-age=31536000; samesite=lax`; };
  system.addEventListener("change", tell);
  tell();

  const listeners = new Set();
  let called = false;
  const call = () => {
    called = false;
    for (const listener of listeners) { listener(); }
  };
  const changed = () => {
    if (called) return;
    called = true;
    setTimeout(call, 120);
  };
  const watch = (shadow) => new MutationObserver(changed).observe(shadow, {childList: true, subtree: true});
  const attach = Element.prototype.attachShadow;
  const shadows = new Set();
  Element.prototype.attachShadow = function (...rest) {
    const shadow = attach.apply(this, rest);
    shadows.add(new WeakRef(shadow));
    watch(shadow);
    changed();
    return shadow;
  };
  watch(document);
  const open = () => {
    const found = [document];
    for (const reference of shadows) {
      const shadow = reference.deref();
      if (!shadow) { shadows.delete(reference); } else if (shadow.host.isConnected) { found.push(shadow); }
    }
    return found;
  };
  window.railjoule = {
    // all elements on the page that match, those within shadow roots included
    deep: (selector) => open().flatMap((one) => [...one.querySelectorAll(selector)]),
    // calls back shortly after anything was added to the page or taken off it
    listen: (listener) => { listeners.add(listener); return () => listeners.delete(listener); },
    // what draws the components of which a page has many, by the names of their modules
    components: {},
    // the name of the chart whose place an element is, as charts.py writes it into a class of the place
    chart_of: (element) => [...element.classList].find((name) => name.startsWith("rj-chart-"))?.slice(9),
  };
})();
