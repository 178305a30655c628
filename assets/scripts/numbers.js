// Numbers as people read them: narrow spaces between thousands, a long minus, and none for what rounds to nothing.

export const written = (value, least, most = least) => {
  const text = Math.abs(value).toLocaleString("en", {minimumFractionDigits: least, maximumFractionDigits: most})
    .replaceAll(",", "\u202f");
  return value < 0 && Number(Math.abs(value).toFixed(most)) ? `\u2212${text}` : text;
};
