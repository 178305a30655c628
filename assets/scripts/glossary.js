// The explanations of terms: a resting mouse or the focus shows one beside its sign, a press opens it in the flow beneath
// what it belongs to, where it covers nothing. One is open at a time; a second press or Escape closes it.
(() => {
  "use strict";
  const {deep, listen} = window.railjoule;
  const open_page = (page) => window.dispatchEvent(new CustomEvent("rj-open", {detail: {page}}));
  const terms = JSON.parse(document.getElementById("rj-glossary").textContent);
  const REST_MS = 350, LEAVE_MS = 150, SETTLED_MS = 300, TURN_WITHIN_MS = 10000, MARGIN_PX = 8;
  const FLOW = "display:block;grid-column:1/-1;box-sizing:border-box;max-width:76ch;font:12px/1.45 var(--rj-font);" +
    "color:var(--rj-ink2);border-left:2px solid var(--rj-accent);padding:2px 0 2px 10px;white-space:normal;";
  const PLACES = ".figures, .proof-row, .strategy, .row, .section, .term-row, .rj-term";
  const button_of = (event) => event.composedPath().find((one) => one.dataset?.term);
  const above = (element) => element.parentElement ?? element.getRootNode().host ?? null;

  // --- beneath its place

  let open = null;
  const value_of = (button) => {
    const value = button.closest(".figure")?.querySelector(".value");
    return value ? `${value.firstChild?.textContent ?? ""} ${value.querySelector("span")?.textContent ?? ""}`.trim() : "";
  };
  const place = (button, node) => {
    let element = button;
    while (element && !element.matches(PLACES)) { element = above(element); }
    if (!element) { return false; }
    if (element.matches(".rj-term")) { element.shadowRoot.append(node); } else { element.after(node); }
    node.style.margin = element.matches(".figures") ? getComputedStyle(element).margin.replace(/^\S+/, "8px")
      : element.matches(".strategy") ? "0 0 6px 8px" : "2px 16px 6px";
    return true;
  };
  const tell = (one) => {
    const {name, text} = terms[one.term], value = value_of(one.button);
    const told = `${name}${value ? `, now ${value}` : ""}: ${text} `;
    if (one.told === told) { return; }
    one.told = told;
    const bold = document.createElement("b"), link = document.createElement("button");
    bold.textContent = name;
    bold.style.color = "var(--rj-ink)";
    link.type = "button";
    link.textContent = "All terms in Help";
    link.style.cssText = "border:0;padding:0;background:none;font:inherit;color:var(--rj-accent);cursor:pointer;min-height:24px";
    link.addEventListener("click", () => help(one.term));
    one.node.replaceChildren(bold, `${value ? `, now ${value}` : ""}: ${text} `, link);
  };
  const close = (refocus = false) => {
    if (!open) { return; }
    const {button, node} = open;
    open = null;
    node.remove();
    button.setAttribute("aria-expanded", "false");
    if (refocus) { button.focus(); }
  };
  const toggle = (button) => {
    const again = open?.button === button;
    close();
    if (again) { return; }
    const node = document.createElement("div");
    node.className = "rj-explained";
    node.setAttribute("role", "note");
    node.style.cssText = FLOW;
    open = {button, node, term: button.dataset.term, root: button.getRootNode()};
    if (!place(button, node)) { open = null; return; }
    button.setAttribute("aria-expanded", "true");
    tell(open);
  };
  // what it stood beneath may have been written anew
  listen(() => {
    if (!open) { return; }
    if (!open.button.isConnected) {
      const button = open.root.host?.isConnected && open.root.querySelector(`[data-term="${open.term}"]`);
      if (!button) { close(); return; }
      open.button = button;
      button.setAttribute("aria-expanded", "true");
    }
    if (!open.node.isConnected) { place(open.button, open.node); }
    tell(open);
  });

  // --- beside its sign, while the mouse or the focus rests there

  let tip = null, waiting = null;
  const hide = () => { clearTimeout(waiting); tip?.remove(); tip = null; };
  const hint = (button) => {
    hide();
    if (open?.button === button) { return; }
    const {name, text} = terms[button.dataset.term];
    tip = document.createElement("div");
    tip.className = "rj-tip";
    tip.setAttribute("role", "tooltip");
    const bold = document.createElement("b");
    bold.textContent = name;
    tip.append(bold, `: ${text}`);
    document.body.append(tip);
    const at = button.getBoundingClientRect(), {offsetWidth: width, offsetHeight: height} = tip;
    tip.style.left = `${Math.max(MARGIN_PX, Math.min(at.left - 12, window.innerWidth - width - MARGIN_PX))}px`;
    tip.style.top = `${at.bottom + height + MARGIN_PX > window.innerHeight ? at.top - height - 2 : at.bottom + 2}px`;
    tip.addEventListener("pointerenter", () => clearTimeout(waiting));
    tip.addEventListener("pointerleave", hide);
  };
  const later = (act, milliseconds) => { clearTimeout(waiting); waiting = setTimeout(act, milliseconds); };

  // --- the page Help, at a term

  const help = (term) => {
    close();
    open_page("Help");
    const until = performance.now() + TURN_WITHIN_MS;
    const look = () => {
      const [entry] = deep(`#term-${term}`);
      if (entry?.offsetHeight && !deep(".rj-turning").length) {
        if (entry.getRootNode().activeElement === entry) { return; }
        entry.scrollIntoView({block: "center"});
        entry.focus({preventScroll: true});
        // a page that has just come may be drawn once more
        setTimeout(look, SETTLED_MS);
      } else if (performance.now() < until) { setTimeout(look, 60); }
    };
    look();
  };

  // events of coming and going do not leave the shadow root within which one comes and goes
  let over = null;
  window.addEventListener("pointermove", (event) => {
    const button = event.pointerType === "mouse" ? button_of(event) ?? null : null;
    if (button === over || tip?.contains(event.target)) { return; }
    over = button;
    if (button) { later(() => hint(button), REST_MS); } else { later(hide, LEAVE_MS); }
  }, {passive: true});
  window.addEventListener("keyup", (event) => {
    const button = event.key === "Tab" && button_of(event);
    if (button) { hint(button); } else if (event.key === "Tab") { hide(); }
  });
  window.addEventListener("wheel", hide, {passive: true});
  window.addEventListener("click", (event) => {
    const button = button_of(event);
    if (button) { hide(); toggle(button); }
    const opener = event.composedPath().find((one) => one.dataset?.open);
    if (opener) { open_page(opener.dataset.open); }
  });
  window.addEventListener("keydown", (event) => {
    if (event.key !== "Escape" || (!tip && !open)) { return; }
    event.stopPropagation();
    if (tip) { hide(); } else { close(true); }
  }, true);
})();
