// Output of the page: files to save, text for the clipboard.

const KEPT_MS = 60000; // a large file may be written that long

export const offer = (content, type, name) => {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([content], {type}));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), KEPT_MS);
};

// Returns whether the text is on the clipboard.
export const copy_text = async (text) => {
  // only safe addresses have a clipboard, and it may be forbidden: then the old way
  try { await navigator.clipboard.writeText(text); return true; } catch { /* the old way */ }
  const area = document.createElement("textarea");
  area.value = text;
  document.body.append(area);
  area.select();
  const copied = document.execCommand("copy");
  area.remove();
  return copied;
};
