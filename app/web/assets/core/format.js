// Numbers and times as people read them; units stand with the number.

const DASH = "–";
const known = (value) => value !== null && value !== undefined && Number.isFinite(Number(value));

/** A length given in metres, shown in millimetres. */
export const mm = (metres, digits = 1) => (known(metres) ? `${(1000 * metres).toFixed(digits)} mm` : DASH);
/** A length given in metres. */
export const metres = (value, digits = 3) => (known(value) ? `${Number(value).toFixed(digits)} m` : DASH);
export const pixels = (value, digits = 2) => (known(value) ? `${Number(value).toFixed(digits)} px` : DASH);
export const degrees = (value, digits = 2) => (known(value) ? `${Number(value).toFixed(digits)}°` : DASH);
export const number = (value, digits = 2) => (known(value) ? Number(value).toFixed(digits) : DASH);
export const count = (value) => (known(value) ? Number(value).toLocaleString("en") : DASH);

/** Bytes in the unit that gives one to three digits before the point. */
export function bytes(value) {
  if (!known(value)) return DASH;
  const units = ["B", "kB", "MB", "GB", "TB"];
  let index = 0;
  for (; value >= 1000 && index < units.length - 1; index += 1) value /= 1000;
  return `${value.toFixed(index && value < 10 ? 1 : 0)} ${units[index]}`;
}

/** A time as ISO 8601 text, shown in the reader's own zone. */
export function time(text) {
  if (!text) return DASH;
  return new Intl.DateTimeFormat(undefined, { dateStyle: "medium", timeStyle: "medium" }).format(new Date(text));
}

/** A message as a sentence begins. */
export const sentence = (text) => text.charAt(0).toUpperCase() + text.slice(1);

/** A word for a count: `plural(2, "photograph")` is "2 photographs". */
export const plural = (value, word, more = `${word}s`) => `${count(value)} ${value === 1 ? word : more}`;
