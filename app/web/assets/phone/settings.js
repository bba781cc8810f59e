// What one sets once: the camera's record, the phone's name, how runs go; and how well the clocks agree.
import { html } from "../core/html.js";
import { Facts, Field, Notice } from "../ui/parts.js";
import { cameraText, fits, knownWithoutName } from "./cameras.js";
import { KEPT_TEXT } from "./offline.js";
import { Lenses } from "./preview.js";

/** Which record of the service stands for the camera that films. */
export function CameraRecord({ site, cameras, size, device_id, chosen, onChoose }) {
  const fitting = size ? cameras.filter((camera) => fits(camera, size.width_px, size.height_px)) : cameras;
  const known = size && knownWithoutName(cameras, device_id, size.width_px, size.height_px);
  return html`<${Field} label="Camera record" hint=${size && `Of those that fit pictures of ${size.width_px} × ${size.height_px}; remembered for this lens and size.`}>
      <select disabled=${!size} value=${chosen ?? ""} onChange=${(event) => onChoose(event.target.value || null)}>
        <option value="">${known ? `Automatic: ${cameraText(known)}` : "Automatic"}</option>
        ${fitting.map((camera) => html`<option value=${camera.camera_id}>${cameraText(camera)}</option>`)}</select></${Field}>
    ${size && !known && !chosen && html`<${Notice} kind="warn"><p>The service does not know which camera films: pictures of a live camera do not say. ${fitting.length ? "Choose its record, or calibrate it." : "Calibrate it, or send photographs."}</p></${Notice}>`}
    <p><a class="button" href=${`#/sites/${site}/phone/calibration`}>Calibrate this camera</a></p>`;
}

/** @param {object} photo {size, wanted, onChange}: the larger photographs that this camera takes when it is not filming; null for none */
export function Settings({ camera, record, photo, device, reading, keptPages }) {
  return html`<details class="card phone-settings"><summary>Camera, clock, this phone</summary><div class="stack">
    <${Lenses} camera=${camera} />
    ${record}
    ${photo && html`<label class="row"><input type="checkbox" checked=${photo.wanted} onChange=${(event) => photo.onChange(event.target.checked)} /> Single pictures as photographs of ${photo.size.width_px} × ${photo.size.height_px}: slower, and their time is less certain</label>`}
    <${Field} label="This phone's name" hint="Snapshots and calibrations carry it as device_id: a phone is known by its own calibration."><input maxlength="100" value=${device.id} onChange=${(event) => device.rename(event.target.value.trim())} /></${Field}>
    <${Facts} of=${[["Clock offset", clockText(reading)], ["Opens offline", KEPT_TEXT[keptPages]]]} />
  </div></details>`;
}

function clockText(reading) {
  if (!reading) return "not compared yet: no answer from the service";
  return html`<span class="number">${seconds(reading.offset_s)} ± ${(1000 * reading.delay_s).toFixed(1)} ms</span>`;
}

const seconds = (value_s) => (Math.abs(value_s) < 1 ? `${value_s < 0 ? "−" : "+"}${Math.abs(1000 * value_s).toFixed(1)} ms` : `${value_s < 0 ? "−" : "+"}${Math.abs(value_s).toFixed(3)} s`);
