// What first.js knows of the whole page, and what components ask of each other.

export const {deep, listen, chart_of} = window.railjoule;

// Whoever can do what is asked listens on the window.
export const ask = (what, detail) => window.dispatchEvent(new CustomEvent(`rj-${what}`, {detail}));
