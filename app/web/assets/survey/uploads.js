// Photographs on their way to a survey: the queue of a page, and what is seen of it.
import { bytes, plural } from "../core/format.js";
import { html, useEffect, useLayoutEffect, useRef, useState } from "../core/html.js";
import { Badge, Button } from "../ui/parts.js";
import { DONE, UploadQueue, nextName } from "./upload_queue.js";

export const ACCEPT = "image/jpeg,image/png,image/webp,image/heic,image/heif,.heic,.heif";
const REFRESH_AFTER_MS = 400; // thumbnails follow uploads, a burst of them at once
const MOST_SHOWN = 12; // that are not done yet

/** The queue of this page, and a question before the page is closed while something is on its way. */
export function useUploads(surveyId, onArrived) {
  const [items, setItems] = useState([]);
  const [left, setLeft] = useState(0);
  const queue = useRef(null);
  useLayoutEffect(() => { // there before files can be chosen
    queue.current = new UploadQueue(surveyId, setItems);
    const ask = (event) => { if (queue.current.busy) event.preventDefault(); };
    addEventListener("beforeunload", ask);
    return () => { removeEventListener("beforeunload", ask); queue.current.close(); };
  }, [surveyId]);
  const arrived = items.filter((item) => item.state === "stored").length;
  useEffect(() => {
    if (!arrived) return undefined;
    const timer = setTimeout(onArrived, REFRESH_AFTER_MS);
    return () => clearTimeout(timer);
  }, [arrived]);
  return { items, queue, left, take: (files) => setLeft(queue.current.add(files)) };
}

const STATES = {
  waiting: ["waiting", "off"], checking: ["looking whether it is there", "info"], sending: ["sending", "info"], lost: ["no connection, tried again", "warn"],
  stored: ["stored", "good"], there: ["was there already", "good"], taken: ["name is taken", "bad"], refused: ["refused", "bad"],
};

/** How far they are. */
export function Uploads({ items, queue }) {
  const done = items.filter((item) => DONE.includes(item.state));
  const there = items.filter((item) => item.state === "there").length;
  const open = items.filter((item) => !DONE.includes(item.state));
  const total = items.reduce((sum, item) => sum + item.file.size, 0);
  const sent = items.reduce((sum, item) => sum + item.sent_bytes, 0);
  return html`<div class="uploads" role="status" aria-label="Uploads">
    <p><b>${done.length} of ${plural(items.length, "photograph")}</b> ${there > 0 && html`<span class="muted">(${there} ${there === 1 ? "was" : "were"} there already)</span>`} <span class="muted">· ${bytes(sent)} of ${bytes(total)}</span></p>
    <progress max=${total} value=${sent} aria-label="All uploads"></progress>
    <ul>${open.slice(0, MOST_SHOWN).map((item) => html`<${Upload} key=${item.id} item=${item} queue=${queue} />`)}</ul>
    ${open.length > MOST_SHOWN && html`<p class="small muted">and ${open.length - MOST_SHOWN} more</p>`}
  </div>`;
}

function Upload({ item, queue }) {
  const [label, kind] = item.error?.status === 401 ? ["waits for a key", "warn"] : STATES[item.state];
  return html`<li><div class="row spread"><span>${item.name}</span><span class="row"><${Badge} kind=${kind}>${label}</${Badge}>
      ${item.state === "taken" && html`<${Button} onClick=${() => queue.current.again(item, nextName(item.name))}>Send as ${nextName(item.name)}</${Button}>`}
      ${["taken", "refused", "lost"].includes(item.state) && html`<${Button} onClick=${() => queue.current.again(item)}>Try again</${Button}>`}</span></div>
    ${item.state === "sending" && html`<progress max=${item.file.size} value=${item.sent_bytes} aria-label=${item.name}></progress>`}
    ${item.error && item.state !== "lost" && html`<p class="small">${item.error.message}</p>`}</li>`;
}
