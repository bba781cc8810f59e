// Photographs on their way: a few at a time, tried again when the connection is lost, none sent that the service has.
import { FULL, KEY_SHOWN, Problem, Unreachable, all } from "../core/api.js";
import { canDigest, sha256Of } from "./digest.js";
import { sendFile } from "./send_file.js";

export const AT_A_TIME = 3; // as many keep a connection full; more wait for the same disk
const FIRST_PAUSE_S = 1;
const LONGEST_PAUSE_S = 20;
const WORTH_WAITING = [401, ...FULL]; // a key ran out or the server is full, the photograph is not wrong
const HOPES = ["online", KEY_SHOWN]; // after these what failed may succeed

export const DONE = ["stored", "there"];

/**
 * @typedef {{id: number, file: File, name: string, state: "waiting"|"checking"|"sending"|"lost"|"stored"|"there"|"taken"|"refused", sent_bytes: number, error: Error | null}} Item
 */

/** Uploads of one survey; `onChange` is called with all items after each change. */
export class UploadQueue {
  constructor(surveyId, onChange) {
    this.surveyId = surveyId;
    this.onChange = onChange;
    this.items = [];
    this.present = null; // a promise of what the service has
    this.stop = new AbortController();
    this.running = 0;
    this.numbered = 0;
    this.wake = () => this.items.filter((item) => item.state === "lost").forEach((item) => this.again(item));
    for (const name of HOPES) addEventListener(name, this.wake);
  }

  /** Take files; those that are no pictures at all are left out and counted. */
  add(files) {
    const pictures = files.filter(isPicture);
    this.present = all(`/surveys/${this.surveyId}/images`, "images");
    this.present.catch(() => {}); // each item tells it
    this.items.push(...pictures.map((file) => ({ id: (this.numbered += 1), file, name: file.name, state: "waiting", sent_bytes: 0, error: null, pause_s: FIRST_PAUSE_S })));
    this.pump();
    return files.length - pictures.length;
  }

  /** Try one again, under another name if one is given. */
  again(item, name = item.name) {
    clearTimeout(item.timer);
    this.present = all(`/surveys/${this.surveyId}/images`, "images");
    this.present.catch(() => {});
    this.set(item, { state: "waiting", name, error: null, sent_bytes: 0 });
    this.pump();
  }

  /** Stop everything; what has arrived stays. */
  close() {
    for (const name of HOPES) removeEventListener(name, this.wake);
    this.items.forEach((item) => clearTimeout(item.timer));
    this.stop.abort();
  }

  get busy() {
    return this.items.some((item) => ["waiting", "checking", "sending", "lost"].includes(item.state));
  }

  set(item, change) {
    Object.assign(item, change);
    if (!this.stop.signal.aborted) this.onChange([...this.items]);
  }

  pump() {
    while (this.running < AT_A_TIME) {
      const next = this.items.find((item) => item.state === "waiting");
      if (!next) break;
      this.running += 1;
      this.send(next).finally(() => { this.running -= 1; this.pump(); });
    }
    this.onChange([...this.items]);
  }

  async send(item) {
    try {
      this.set(item, { state: "checking" });
      if (await this.isThere(item)) return this.set(item, { state: "there", sent_bytes: item.file.size });
      this.set(item, { state: "sending" });
      const path = `/surveys/${this.surveyId}/images/${encodeURIComponent(item.name)}`;
      const answer = await sendFile(path, item.file, (sent_bytes) => this.set(item, { sent_bytes }), this.stop.signal);
      return this.set(item, { state: answer.created ? "stored" : "there", sent_bytes: item.file.size, pause_s: FIRST_PAUSE_S });
    } catch (error) {
      return this.fail(item, error);
    }
  }

  /** Whether the service has these bytes already, under whatever name. */
  async isThere(item) {
    const present = await this.present;
    if (!canDigest() || !present.length) return false;
    const sha256 = await sha256Of(item.file);
    return present.some((photo) => photo.sha256 === sha256);
  }

  fail(item, error) {
    if (error.name === "AbortError") return;
    const waits = error instanceof Unreachable || WORTH_WAITING.includes(error.status);
    if (!waits) {
      this.set(item, { state: error instanceof Problem && error.status === 409 ? "taken" : "refused", error });
      return;
    }
    const pause_s = error.retry_after_s ?? item.pause_s;
    if (error.status !== 401) item.timer = setTimeout(() => this.again(item), 1000 * pause_s); // a key is shown by somebody
    this.set(item, { state: "lost", error, pause_s: Math.min(2 * item.pause_s, LONGEST_PAUSE_S) });
  }
}

/** Another name for a photograph whose name is taken: "IMG_1 (2).jpg". */
export function nextName(name) {
  const [, stem, number, ending] = /^(.*?)(?: \((\d+)\))?(\.[^.]*)?$/.exec(name);
  return `${stem} (${Number(number ?? 1) + 1})${ending ?? ""}`;
}

/** Phones give HEIC no type; the service looks at the bytes. */
const isPicture = (file) => file.type.startsWith("image/") || /\.(jpe?g|png|webp|hei[cf])$/i.test(file.name);
