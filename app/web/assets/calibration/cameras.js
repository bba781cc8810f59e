// Cameras that the site's snapshots are located with: where each comes from, how well it is known; forget one.
import { remove } from "../core/api.js";
import { number, pixels, time } from "../core/format.js";
import { useAction } from "../core/hooks.js";
import { html, useState } from "../core/html.js";
import { may } from "../core/session.js";
import { Badge, Button, Dialog, Empty, Failure, Loaded, Table } from "../ui/parts.js";

const SOURCES = { survey: ["survey", "good"], calibration: ["calibration", "good"], client: ["told by the phone", "info"], exif: ["EXIF", "warn"], model: ["another unit", "warn"] };
const nameOf = (camera) => `${camera.make} ${camera.model}`.trim() || "a camera without a name";

/**
 * @param {object} given
 * @param {{data: any[] | null}} given.cameras of the site
 * @param {string | undefined} given.fresh id of the one that was calibrated just now
 */
export function Cameras({ cameras, fresh, who }) {
  const [doomed, setDoomed] = useState(null);
  const columns = columnsOf(fresh, may(who, "survey") ? setDoomed : null);
  return html`<section class="cameras"><h2>Cameras of this site</h2>
    <p class="muted">A snapshot is located with the best that is known of its camera: its own device's calibration first, then another unit of the model. A camera is known for one picture size.</p>
    <${Loaded} of=${cameras}>${(found) => (found.length ? html`<${Table} caption="Cameras" columns=${columns} rows=${found} keyOf=${(camera) => camera.camera_id} sortBy="made" descending=${true} />`
      : html`<${Empty}>No camera yet: snapshots are located with what EXIF tells of the focal length, or with what the phone sends along.</${Empty}>`)}</${Loaded}>
    ${doomed && html`<${Forget} camera=${doomed} onDone=${() => { setDoomed(null); cameras.reload(); }} onClose=${() => setDoomed(null)} />`}</section>`;
}

function columnsOf(fresh, forget) {
  return [
    { key: "device", label: "Device", kind: "name", value: (camera) => camera.device_id, show: (camera) => html`${camera.device_id ?? html`<span class="muted">any of the model</span>`} ${camera.camera_id === fresh && html`<${Badge} kind="info">new</${Badge}>`}` },
    { key: "camera", label: "Camera", kind: "name", value: nameOf },
    { key: "size", label: "Picture", right: true, value: (camera) => camera.width_px, show: (camera) => `${camera.width_px} × ${camera.height_px}` },
    { key: "source", label: "From", value: (camera) => camera.source, show: (camera) => html`<${Badge} kind=${SOURCES[camera.source]?.[1]}>${SOURCES[camera.source]?.[0] ?? camera.source}</${Badge}> ${camera.map_version && html`<span class="small muted">map ${camera.map_version}</span>`}` },
    { key: "focal", label: "Focal length", right: true, value: (camera) => camera.fx, show: (camera) => pixels(camera.fx, 1) },
    { key: "sigma", label: "σ", right: true, value: (camera) => camera.sigmas.fx / camera.fx, show: (camera) => `${pixels(camera.sigmas.fx, 1)}, ${number((100 * camera.sigmas.fx) / camera.fx, 2)} %` },
    { key: "made", label: "Made", value: (camera) => camera.created_at, show: (camera) => time(camera.created_at) },
    ...(forget ? [{ key: "forget", label: "Forget", value: () => null, show: (camera) => html`<${Button} kind="danger" aria-label=${`Forget ${nameOf(camera)} of ${time(camera.created_at)}`} onClick=${() => forget(camera)}>Forget</${Button}>` }] : []),
  ];
}

function Forget({ camera, onDone, onClose }) {
  const forgetting = useAction(async () => { await remove(`/cameras/${camera.camera_id}`); onDone(); });
  return html`<${Dialog} title="Forget the camera" onClose=${onClose}><div class="stack">
    <p>From now on snapshots of ${camera.device_id ?? nameOf(camera)} are located by the next best camera that is known. Poses that it gave stay.</p>
    <${Failure} error=${forgetting.error} />
    <div><${Button} kind="danger" busy=${forgetting.busy} onClick=${forgetting.run}>Forget it</${Button}></div></div></${Dialog}>`;
}
