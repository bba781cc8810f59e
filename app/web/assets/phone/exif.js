// What a photograph's file says of itself: when it was taken, and whether it names its camera.

const APP1 = 0xffe1;
const SCAN = 0xffda; // from here on there are pixels
const EXIF = 0x45786966; // "Exif"
const LITTLE = 0x4949; // "II": least byte first
const HEAD_BYTES = 256 * 1024; // EXIF stands in the first segments, of 64 kB at most
const TAGS = { model: 0x0110, ifd: 0x8769, taken: 0x9003, zone: 0x9011, fraction: 0x9291 };
const WHOLE_SECOND_S = 0.5; // how far a time without a fraction can be from its middle

/**
 * When a photograph was taken by the clock of its phone, from EXIF; from the file's own time when it has none.
 * @param {File} file
 * @returns {Promise<{captured_ms: number, spread_s: number, names_camera: boolean}>}
 */
export async function momentOfFile(file) {
  const tags = tagsOf(new DataView(await file.slice(0, HEAD_BYTES).arrayBuffer()));
  return { ...(momentOf(tags) ?? { captured_ms: file.lastModified, spread_s: WHOLE_SECOND_S }), names_camera: Boolean(tags.model) };
}

/** "2026:11:20 10:00:04" in the zone that the file names, otherwise in the phone's. */
function momentOf({ taken, fraction, zone }) {
  const parts = /^(\d{4}):(\d\d):(\d\d) (\d\d):(\d\d):(\d\d)/.exec(taken ?? "");
  if (!parts) return null;
  const [, year, month, day, hour, minute, second] = parts;
  const offset = /^[+-]\d\d:\d\d$/.test(zone ?? "") ? zone : "";
  const whole_ms = Date.parse(`${year}-${month}-${day}T${hour}:${minute}:${second}${offset}`);
  if (Number.isNaN(whole_ms)) return null;
  return /^\d+$/.test(fraction ?? "") ? { captured_ms: whole_ms + 1000 * Number(`0.${fraction}`), spread_s: 0 } : { captured_ms: whole_ms + 1000 * WHOLE_SECOND_S, spread_s: WHOLE_SECOND_S };
}

/** The texts of the tags that are wanted; a file that is cut or no JPEG has none. */
function tagsOf(view) {
  try {
    for (let at = 2; at + 10 < view.byteLength && view.getUint16(at) >= APP1 - 1 && view.getUint16(at) !== SCAN; at += 2 + view.getUint16(at + 2)) {
      if (view.getUint16(at) === APP1 && view.getUint32(at + 4) === EXIF) return textsOf(view, at + 10);
    }
    return {};
  } catch (error) {
    if (error instanceof RangeError) return {}; // it points beyond its end
    throw error;
  }
}

function textsOf(view, start) {
  const little = view.getUint16(start) === LITTLE;
  const first = entriesOf(view, start, view.getUint32(start + 4, little), little);
  const second = first.has(TAGS.ifd) ? entriesOf(view, start, view.getUint32(first.get(TAGS.ifd) + 8, little), little) : new Map();
  const text = (entries, tag) => (entries.has(tag) ? textAt(view, start, entries.get(tag), little) : undefined);
  return { model: text(first, TAGS.model), taken: text(second, TAGS.taken), fraction: text(second, TAGS.fraction), zone: text(second, TAGS.zone) };
}

/** Where the entries of a directory stand, by their tags. */
function entriesOf(view, start, offset, little) {
  const count = view.getUint16(start + offset, little);
  return new Map(Array.from({ length: count }, (_, index) => start + offset + 2 + 12 * index).map((at) => [view.getUint16(at, little), at]));
}

function textAt(view, start, at, little) {
  const length = view.getUint32(at + 4, little);
  const from = length > 4 ? start + view.getUint32(at + 8, little) : at + 8;
  return String.fromCharCode(...new Uint8Array(view.buffer, view.byteOffset + from, length)).replace(/\0.*$/s, "").trim();
}
