// Numbers as people read them: narrow spaces between thousands, a long minus, and none for what rounds to nothing.

// not by toLocaleString: the formatter that it makes each time takes longer than the rest of a tick
export const written = (value, least, most = least) => {
  const [whole, part = ""] = Math.abs(value).toFixed(most).split("."), kept = part.replace(/0+$/, "").padEnd(least, "0");
  const text = whole.replace(/\B(?=(\d{3})+$)/g, "\u202f") + (kept && `.${kept}`);
  return value < 0 && /[1-9]/.test(text) ? `\u2212${text}` : text;
};
