// Answers as files in the reader's downloads.
import { call } from "./api.js";

const READ_MS = 10_000; // until then the browser has begun to write

/** Give a file to the browser's downloads. */
export function saveAs(blob, name) {
  const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), READ_MS);
}

/** Ask for a file and save it; a refusal is an error to show, not a file. */
export const download = async (path, name) => saveAs(await (await call(path)).blob(), name);
