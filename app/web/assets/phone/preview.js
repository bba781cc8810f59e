// What the camera sees, or why nothing is seen and what to do about it.
import { html, useEffect, useRef } from "../core/html.js";
import { Busy, Button, Field, Notice } from "../ui/parts.js";

const WAYS_OUT = {
  insecure: html`<p><b>The camera needs a secure page.</b> Browsers lend it to https addresses and to this very machine only.</p>
    <p>Start the service with <code>scattermark serve --lan</code> and read the code it prints with the phone. Photographs of the phone's own camera app can be sent from here as it is.</p>`,
  refused: html`<p><b>This page may not use the camera.</b> Allow it: tap the sign left of the address, then Camera, then try again.</p>`,
  none: html`<p><b>This device has no camera.</b> Photographs can be sent as files all the same.</p>`,
  taken: html`<p><b>The camera is taken.</b> Another app or tab uses it: close that, then try again.</p>`,
  failed: html`<p><b>The camera does not start.</b></p>`,
};

/**
 * The picture, and a second one of two pixels in a corner that pictures are taken from: browsers give no frames of a video that is
 * scrolled out of sight.
 * @param {{current: HTMLVideoElement}} eye where the second one is put
 */
export function Preview({ camera, eye, size, onSize }) {
  const shown = useRef(null);
  useEffect(() => { for (const video of [shown.current, eye.current]) if (video) video.srcObject = camera.stream; }, [camera.stream, camera.trouble]);
  if (camera.trouble) return html`<${Notice} kind="warn">${WAYS_OUT[camera.trouble.kind]}
    ${camera.trouble.kind === "failed" && html`<p>${camera.trouble.message}</p>`}
    ${camera.trouble.kind !== "insecure" && html`<p><${Button} onClick=${camera.again}>Try again</${Button}></p>`}</${Notice}>`;
  const measured = () => onSize({ width_px: eye.current.videoWidth, height_px: eye.current.videoHeight });
  return html`<div class="phone-view">
    <video ref=${shown} playsinline muted autoplay aria-label="What the camera sees"></video>
    <video class="phone-eye" ref=${eye} playsinline muted autoplay aria-hidden="true" tabindex="-1" onLoadedMetadata=${measured} onResize=${measured}></video>
    ${!camera.stream ? html`<p class="phone-starting"><${Busy} /> starting the camera</p>` : size && html`<span class="phone-chip number">${size.width_px} × ${size.height_px}</span>`}
  </div>`;
}

/** Which of several lenses films. */
export const Lenses = ({ camera }) => camera.lenses.length > 1 && html`<${Field} label="Lens"><select value=${camera.lens?.id} onChange=${(event) => camera.choose(event.target.value)}>
  ${camera.lenses.map((lens) => html`<option value=${lens.id}>${lens.label}</option>`)}</select></${Field}>`;
