// Pictures for a calibration from the camera that the phone page films with: what is filmed has a camera of its own.
import { html, useEffect, useRef, useState } from "../core/html.js";
import { useCamera } from "../phone/camera.js";
import { followFrames, frameOf } from "../phone/picture.js";
import { useAction } from "../core/hooks.js";
import { Button, Failure, Notice } from "../ui/parts.js";
import { nameNow } from "./names.js";

const TROUBLES = {
  insecure: "Browsers open the camera on pages of HTTPS and of this very machine alone. Choose photographs instead.",
  refused: "The browser was told not to open the camera. Allow it in the address bar, or choose photographs.",
  none: "This device has no camera. Choose photographs instead.",
  taken: "Another program holds the camera.",
};

/** @param {(files: File[]) => void} given.onFiles */
export function Live({ onFiles }) {
  const [open, setOpen] = useState(false);
  const camera = useCamera(open);
  const [video, frames] = [useRef(null), useRef(null)];
  useEffect(() => {
    if (!camera.stream) return undefined;
    video.current.srcObject = camera.stream;
    frames.current = followFrames(video.current);
    return () => frames.current.end();
  }, [camera.stream]);
  const taking = useAction(async () => {
    const { blob } = await frameOf(video.current, frames.current);
    onFiles([new File([blob], nameNow("frame", ".jpg"), { type: blob.type })]);
  });
  if (!open) return html`<${Button} onClick=${() => setOpen(true)}>Use the live camera</${Button}>`;
  return html`<div class="live"><${Failure} error=${taking.error} />
    ${camera.trouble && html`<${Notice} kind="warn"><p>${TROUBLES[camera.trouble.kind] ?? camera.trouble.message}</p></${Notice}>`}
    ${!camera.trouble && html`<video ref=${video} autoplay muted playsinline aria-label="What the camera sees"></video>`}
    <div class="row"><${Button} kind="primary" busy=${taking.busy} disabled=${!camera.stream} onClick=${taking.run}>Take this picture</${Button}><${Button} onClick=${() => setOpen(false)}>Close the camera</${Button}></div>
    <p class="small muted">For the phone page's live view: film and photograph differ in size, so that each is calibrated by itself.</p></div>`;
}
