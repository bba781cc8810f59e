// Photographs of a survey: dropped, sent with their progress, shown small.
import { bytes, plural } from "../core/format.js";
import { html, useEffect, useRef, useState } from "../core/html.js";
import { Badge, Button, Drop, Failure, Loaded, Notice } from "../ui/parts.js";
import { canDigest } from "./digest.js";
import { useExclusion } from "./exclusion.js";
import { Thumbnail } from "./thumbnail.js";
import { DONE, UploadQueue, nextName } from "./upload_queue.js";

const ACCEPT = "image/jpeg,image/png,image/webp,image/heic,image/heif,.heic,.heif";
const REFRESH_AFTER_MS = 400; // thumbnails follow uploads, a burst of them at once

export function Photographs({ site, surveyId, photos, guidance }) {
  const { items, queue, left, take } = useUploads(surveyId, photos.reload);
  return html`<section class="card" aria-label="Photographs"><h2>Photographs</h2>
    <${Drop} accept=${ACCEPT} onFiles=${take} label="Choose photographs">
      <p>Drop photographs or a whole folder here.</p>
      <p class="small muted">JPEG, PNG, WebP or HEIC, at full size. Drop the same folder again after a break: what has arrived is not sent twice.</p>
      <${FolderButton} onFiles=${take} />
    </${Drop}>
    ${!canDigest() && html`<p class="small muted">This page came by plain HTTP, where browsers compute no digests: photographs that are there already are sent again, which changes nothing. By HTTPS they would be skipped.</p>`}
    ${left > 0 && html`<${Notice} kind="warn">${plural(left, "file")} left out: no photograph.</${Notice}>`}
    ${items.length > 0 && html`<${Uploads} items=${items} queue=${queue} />`}
    <${Loaded} of=${photos}>${(found) => html`<${Thumbnails} site=${site} surveyId=${surveyId} photos=${found} guidance=${guidance} />`}</${Loaded}>
  </section>`;
}

function FolderButton({ onFiles }) {
  const input = useRef(null);
  return html`<input ref=${input} class="visually-hidden" type="file" webkitdirectory tabindex="-1" aria-label="Folder of photographs" onChange=${(event) => { onFiles([...event.target.files]); event.target.value = ""; }} />
    <${Button} onClick=${() => input.current.click()}>Choose a folder</${Button}> `;
}

/** The queue of this page, and a question before the page is closed while something is on its way. */
function useUploads(surveyId, onArrived) {
  const [items, setItems] = useState([]);
  const [left, setLeft] = useState(0);
  const queue = useRef(null);
  useEffect(() => {
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

function Uploads({ items, queue }) {
  const done = items.filter((item) => DONE.includes(item.state));
  const there = items.filter((item) => item.state === "there").length;
  const open = items.filter((item) => !DONE.includes(item.state));
  const total = items.reduce((sum, item) => sum + item.file.size, 0);
  const sent = items.reduce((sum, item) => sum + item.sent_bytes, 0);
  return html`<div class="uploads" role="status" aria-label="Uploads">
    <p><b>${done.length} of ${plural(items.length, "photograph")}</b> ${there > 0 && html`<span class="muted">(${there} ${there === 1 ? "was" : "were"} there already)</span>`} <span class="muted">· ${bytes(sent)} of ${bytes(total)}</span></p>
    <progress max=${total} value=${sent} aria-label="All uploads"></progress>
    <ul>${open.slice(0, 12).map((item) => html`<${Upload} key=${item.id} item=${item} queue=${queue} />`)}</ul>
    ${open.length > 12 && html`<p class="small muted">and ${open.length - 12} more</p>`}
  </div>`;
}

function Upload({ item, queue }) {
  const [label, kind] = STATES[item.state];
  return html`<li><div class="row spread"><span>${item.name}</span><span class="row"><${Badge} kind=${kind}>${label}</${Badge}>
      ${item.state === "taken" && html`<${Button} onClick=${() => queue.current.again(item, nextName(item.name))}>Send as ${nextName(item.name)}</${Button}>`}
      ${["taken", "refused", "lost"].includes(item.state) && html`<${Button} onClick=${() => queue.current.again(item)}>Try again</${Button}>`}</span></div>
    ${item.state === "sending" && html`<progress max=${item.file.size} value=${item.sent_bytes} aria-label=${item.name}></progress>`}
    ${item.error && item.state !== "lost" && html`<p class="small">${item.error.message}</p>`}</li>`;
}

function Thumbnails({ site, surveyId, photos, guidance }) {
  const [exclusion, change] = useExclusion(surveyId);
  if (!photos.length) return null;
  const word = wordsOf(guidance);
  const total = photos.reduce((sum, photo) => sum + photo.bytes, 0);
  return html`<p class="small muted">${plural(photos.length, "photograph")}, ${bytes(total)}. Open one to see what was found in it.</p>
    <ul class="thumbnails" aria-label="Photographs of the survey">${photos.map((photo) => html`<li key=${photo.name} class=${exclusion.images.includes(photo.name) ? "left-out" : ""}>
      <a href=${`#/sites/${site.site_id}/surveys/${surveyId}/photos/${encodeURIComponent(photo.name)}`}>
        <${Thumbnail} surveyId=${surveyId} name=${photo.name} />
        <span>${photo.name}</span></a>
      ${word(photo.name)}
      <label class="small"><input type="checkbox" checked=${!exclusion.images.includes(photo.name)} onChange=${() => change("images", photo.name)} /> use</label></li>`)}</ul>`;
}

/** What guidance says of a photograph. */
function wordsOf(guidance) {
  const loose = new Set(guidance?.loose ?? []);
  const unusable = new Set(guidance?.unusable ?? []);
  return (name) => (unusable.has(name) ? html`<${Badge} kind="bad">cannot be read</${Badge}>` : loose.has(name) ? html`<${Badge} kind="warn">hangs together with none</${Badge}>` : null);
}
