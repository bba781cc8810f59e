// The photographs of a calibration: chosen, taken, sent; each with what was seen in it and how well it fits.
import { pixels, plural } from "../core/format.js";
import { html, useEffect, useRef } from "../core/html.js";
import { Thumbnail } from "../survey/thumbnail.js";
import { ACCEPT, Uploads, useUploads } from "../survey/uploads.js";
import { Badge, Button, Drop, Failure, Notice } from "../ui/parts.js";
import { Live } from "./live.js";
import { nameNow } from "./names.js";

/** Where photographs come from; `filming` is whether the live camera is open, and a way to open it. */
export const Choose = ({ onFiles, filming: [open, onOpen] }) => html`<${Drop} accept=${ACCEPT} onFiles=${onFiles} label="Choose photographs">
    <p>Drop 5 to 20 photographs of this site's targets here.</p>
    <p class="small muted">As the phone's camera wrote them: one size, no zoom, standing still.</p>
    <${TakeButton} onFiles=${onFiles} />
  </${Drop}><${Live} onFiles=${onFiles} open=${open} onOpen=${onOpen} />`;

/** The device's own camera, where it has one: at full size, one photograph at a time. */
function TakeButton({ onFiles }) {
  const input = useRef(null);
  const take = (event) => {
    onFiles([...event.target.files].map((file) => new File([file], nameOf(file), { type: file.type, lastModified: file.lastModified })));
    event.target.value = "";
  };
  return html`<input ref=${input} class="visually-hidden" type="file" accept="image/*" capture="environment" tabindex="-1" aria-label="Photograph from the camera" onChange=${take} />
    <${Button} onClick=${() => input.current.click()}>Take a photograph</${Button}> `;
}

const nameOf = (file) => nameNow("photo", /\.\w+$/.exec(file.name)?.[0] ?? ".jpg");

/**
 * @param {object} given
 * @param {{data: any[] | null, error: Error | null, reload: () => void}} given.photos of the survey that holds them
 * @param {File[]} given.first files that were chosen before there was a survey
 * @param {object | null} given.result of the calibration: what it says of each photograph
 * @param {[boolean, (open: boolean) => void]} given.filming whether the live camera is open
 */
export function Photographs({ site, surveyId, photos, seen, first, filming, result, onPick }) {
  const { items, queue, left, take } = useUploads(surveyId, photos.reload);
  useEffect(() => { if (first.length) take(first); }, [surveyId]);
  return html`<section class="card" aria-label="Photographs"><h2>Photographs</h2>
    <${Choose} onFiles=${take} filming=${filming} />
    ${left > 0 && html`<${Notice} kind="warn">${plural(left, "file")} left out: no photograph.</${Notice}>`}
    ${items.length > 0 && html`<${Uploads} items=${items} queue=${queue} />`}
    <${Failure} error=${photos.error} retry=${photos.reload} />
    <ul class="thumbnails" aria-label="Photographs of the set">${(photos.data ?? []).map(({ name }) => html`<li key=${name} onPointerEnter=${() => onPick(name)} onPointerLeave=${() => onPick(null)} onFocusIn=${() => onPick(name)} onFocusOut=${() => onPick(null)}>
      <a href=${`#/sites/${site.site_id}/surveys/${surveyId}/photos/${encodeURIComponent(name)}`}><${Thumbnail} surveyId=${surveyId} name=${name} /><span>${name}</span></a>
      <${Word} name=${name} seen=${seen} result=${result} /></li>`)}</ul></section>`;
}

/** What is known of one photograph. */
function Word({ name, seen, result }) {
  const used = result?.photographs.find((photo) => photo.name === name);
  const out = result?.left_out.find((photo) => photo.name === name);
  const [detection, error] = [seen.found.get(name), seen.failed.get(name)];
  if (used) return html`<${Badge} kind="good">${pixels(used.rms_residual_px, 3)}</${Badge}>`;
  if (out) return html`<${Badge} kind="warn">left out</${Badge}><span class="small muted">${out.detail}</span>`;
  if (error) return html`<${Badge} kind="bad">cannot be read</${Badge}><span class="small muted">${error.message}</span>`;
  if (!detection) return html`<${Badge} kind="off">looking</${Badge}>`;
  return detection.targets.length ? html`<${Badge} kind="info">${plural(detection.targets.length, "target")}</${Badge}>` : html`<${Badge} kind="warn">no target</${Badge}>`;
}
