// Photographs of a survey: dropped, sent with their progress, shown small.
import { bytes, plural } from "../core/format.js";
import { html, useRef } from "../core/html.js";
import { Badge, Button, Drop, Loaded, Notice } from "../ui/parts.js";
import { canDigest } from "./digest.js";
import { useExclusion } from "./exclusion.js";
import { Thumbnail } from "./thumbnail.js";
import { ACCEPT, Uploads, useUploads } from "./uploads.js";

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
