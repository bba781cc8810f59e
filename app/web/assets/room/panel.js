// All that is known of what is picked.
import { degrees, metres, mm, number, pixels, plural, time } from "../core/format.js";
import { html } from "../core/html.js";
import { Badge, Button, Facts } from "../ui/parts.js";
import { principalAxes, positionCovariance } from "./covariance.js";
import { seenWith } from "./load.js";

const AXES = ["x", "y", "z"];

/** Three numbers, each with its axis. */
const triple = (values, show) => html`<span class="triple">${AXES.map((axis, index) => html`<span><i>${axis}</i> ${show(values?.[index])}</span>`)}</span>`;

/** Facts of an item; `onPick` picks another. */
export function Picked({ item, room, site, onPick, onFace, drawn }) {
  const View = { target: Target, photo: Photo, point: Point, pose: Pose }[item.kind];
  return html`<section class="card picked" aria-label="Picked" aria-live="polite">
    <${View} item=${item} room=${room} site=${site} onPick=${onPick} />
    <div class="row">${drawn && html`<${Button} onClick=${() => onFace(item)}>Look at it</${Button}>`}<${Button} kind="plain" onClick=${() => onPick(null)}>Clear</${Button}></div>
  </section>`;
}

function Target({ item, room, site, onPick }) {
  const [whole, own] = [principalAxes(positionCovariance(item, room.datum)), principalAxes(positionCovariance(item, null))];
  const photos = seenWith(room, item);
  const known = room.photos.some((photo) => photo.codes);
  return html`<h2>Target ${item.code}</h2><${Facts} of=${[
      ["Position", triple(item.position_m, (value) => metres(value, 4))],
      ["σ", triple(item.sigma_m, (value) => mm(value, 2))],
      ["Ellipsoid", html`${whole.sigmas.map((sigma) => (1000 * sigma).toFixed(2)).join(" × ")} mm`],
      ["… without the datum", html`${own.sigmas.map((sigma) => (1000 * sigma).toFixed(2)).join(" × ")} mm`],
      ["Rays", plural(item.rays, "photograph")], ["Residual", `${pixels(item.rms_px)} rms`]]} />
    ${known && html`<h3>Seen in</h3><ul class="chips">${photos.map((photo) => html`<li><${Button} onClick=${() => onPick(photo)}>${photo.name}</${Button}></li>`)}</ul>`}
    ${room.points.filter((point) => point.code === item.code).map((point) => html`<p class="small">Carries ${point.role} point <a href="#point" onClick=${(event) => { event.preventDefault(); onPick(point); }}>${point.name}</a>.</p>`)}
    <p class="small"><a href=${`#/sites/${site}/report?version=${room.version}`}>Report of version ${room.version}</a></p>`;
}

function Photo({ item, room, site, onPick }) {
  const targets = seenWith(room, item);
  return html`<h2>Photograph ${item.name}</h2><${Facts} of=${[
      ["Camera stood at", triple(item.position_m, (value) => metres(value, 4))], ["σ", triple(item.position_sigma_m, (value) => mm(value, 2))],
      ["Residual", `${pixels(item.rms_px)} rms`], ["Camera", item.camera ? `${item.camera.width_px} × ${item.camera.height_px} px, f ${number(item.camera.fx, 0)} px, ${degrees(fieldDeg(item.camera), 0)} wide` : "–"]]} />
    ${item.codes && html`<h3>Shows ${plural(item.codes.length, "target")}</h3><ul class="chips">${targets.map((target) => html`<li><${Button} onClick=${() => onPick(target)}>${target.code}</${Button}></li>`)}</ul>`}
    ${room.surveyId && html`<p class="small"><a href=${`#/sites/${site}/surveys/${room.surveyId}/photos/${encodeURIComponent(item.name)}`}>Open the photograph</a></p>`}`;
}

const fieldDeg = (camera) => (360 / Math.PI) * Math.atan(camera.width_px / 2 / camera.fx);

function Point({ item, room, onPick }) {
  const target = room.targets.find((one) => one.code === item.code);
  const off_m = item.residual_m && Math.hypot(...item.residual_m);
  return html`<h2>${item.role === "check" ? "Check" : "Control"} point ${item.name}</h2><${Facts} of=${[
      ["Role", html`<${Badge} kind=${item.role === "check" ? "good" : "bad"}>${item.role}</${Badge}> ${item.role === "check" ? "never used in the fit" : "fixes the frame"}`],
      ["On", target ? html`<a href="#target" onClick=${(event) => { event.preventDefault(); onPick(target); }}>target ${item.code}</a>, ${item.dot}` : `target ${item.code}, ${item.dot}`],
      ["Listed", triple(item.position_m, (value) => metres(value, 4))], ["σ listed", mm(item.sigma_m, 2)],
      ["Map − list", item.residual_m ? triple(item.residual_m, (value) => mm(value, 2)) : "its target is not in the map"], ["Distance", mm(off_m, 2)]]} />`;
}

const Pose = ({ item }) => html`<h2>Located pose</h2><${Facts} of=${[
  ["Time", time(item.at)], ["Position", triple(item.position_m, (value) => metres(value, 4))],
  ["σ", item.sigma_m ? triple(item.sigma_m, (value) => mm(value, 2)) : "not told"],
  ["Trajectory", html`<a href=${`#/trajectories/${item.trajectory.trajectory_id}`}>${nameOf(item.trajectory)}</a>`]]} />`;

/** What a trajectory is called. */
export const nameOf = (trajectory) => trajectory.name || trajectory.device_id || trajectory.trajectory_id.slice(0, 8);
