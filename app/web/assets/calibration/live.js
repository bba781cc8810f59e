// Pictures for a calibration from the camera that the phone page films with: what is filmed has a camera of its own.
import { html, useRef, useState } from "../core/html.js";
import { useAction } from "../core/hooks.js";
import { useCamera } from "../phone/camera.js";
import { frameOf } from "../phone/picture.js";
import { Preview } from "../phone/preview.js";
import { Button, Failure } from "../ui/parts.js";
import { nameNow } from "./names.js";

/**
 * @param {object} given
 * @param {(files: File[]) => void} given.onFiles
 * @param {boolean} given.open whether the camera films; whoever shows this keeps it, so that a set that begins with a picture goes on with it
 * @param {(open: boolean) => void} given.onOpen
 */
export function Live({ onFiles, open, onOpen }) {
  const [size, setSize] = useState(null);
  const camera = useCamera(open);
  const eye = useRef(null); // the video that pictures are taken from
  const taking = useAction(async () => {
    const { blob } = await frameOf(eye.current);
    onFiles([new File([blob], nameNow("frame", ".jpg"), { type: blob.type })]);
  });
  if (!open) return html`<${Button} onClick=${() => onOpen(true)}>Use the live camera</${Button}>`;
  return html`<div class="live"><${Failure} error=${taking.error} />
    <${Preview} camera=${camera} eye=${eye} size=${size} onSize=${setSize} />
    <div class="row"><${Button} kind="primary" busy=${taking.busy} disabled=${!camera.stream || !size} onClick=${taking.run}>Take this picture</${Button}><${Button} onClick=${() => { onOpen(false); setSize(null); }}>Close the camera</${Button}></div>
    <p class="small muted">For the phone page's live view: what is filmed and what is photographed differ in size, so that each is calibrated by itself.</p></div>`;
}
