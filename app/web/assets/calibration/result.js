// What a calibration found: the camera with its uncertainty, what the photographs left open, how well each of them fits.
import { html } from "../core/html.js";
import { number, pixels, plural } from "../core/format.js";
import { Badge, Figures, Notice, Table } from "../ui/parts.js";

const DISTORTION = ["k1", "k2", "p1", "p2", "k3"];
const MEANS = {
  fx: "focal length across", fy: "focal length down", cx: "principal point across", cy: "principal point down",
  k1: "radial distortion", k2: "radial distortion", p1: "decentring", p2: "decentring", k3: "radial distortion",
};
const PERCENT = 100;

/** @param {object} given.result of the job, as `GET /jobs/{job_id}` tells it */
export function Result({ result }) {
  return html`<${Figures} of=${[
      ["focal length", html`${pixels(result.fx, 1)} <small>± ${pixels(sigmaOf(result, 0), 1)}</small>`],
      ["residuals, RMS of a coordinate", pixels(result.rms_residual_px, 3)],
      ["breathing: focal length from photograph to photograph", `${number(PERCENT * result.focal_scatter, 3)} %`],
      ["photographs, targets", `${result.photographs.length}, ${result.targets}`]]} />
    <div class="columns"><section><h3>Intrinsics</h3><${Intrinsics} result=${result} /></section>
      <section><h3>Photographs by their residuals</h3><${Residuals} result=${result} /></section></div>
    <${Remarks} result=${result} />`;
}

const sigmaOf = (result, index) => Math.sqrt(result.covariance[index][index]);

function Intrinsics({ result }) {
  const values = [...["fx", "fy", "cx", "cy"].map((name) => [name, result[name]]), ...DISTORTION.map((name, index) => [name, result.dist[index]])];
  const rows = values.map(([name, value], index) => ({ name, index, value, sigma: sigmaOf(result, index), held: result.not_carried.includes(name) }));
  const digits = (row) => (DISTORTION.includes(row.name) ? 5 : 2);
  const columns = [
    { key: "name", label: "Intrinsic", value: (row) => row.index, show: (row) => html`<b>${row.name}</b> <span class="muted">${MEANS[row.name]}</span> ${row.held && html`<${Badge} kind="warn">held</${Badge}>`}` },
    { key: "value", label: "Value", right: true, value: (row) => row.value, show: (row) => number(row.value, digits(row)) },
    { key: "sigma", label: "σ", right: true, value: (row) => row.sigma, show: (row) => number(row.sigma, digits(row)) },
  ];
  return html`<${Table} caption="Intrinsics" columns=${columns} rows=${rows} keyOf=${(row) => row.name} sortBy="name" />
    <p class="small muted">Focal lengths and principal point in pixels of ${result.width_px} × ${result.height_px}; σ includes how far photographs differ from each other (principal point by ${result.centre_scatter_px.map((value) => number(value)).join(" and ")} px).</p>`;
}

function Residuals({ result }) {
  const worst = Math.max(...result.photographs.map((photo) => photo.rms_residual_px));
  const columns = [
    { key: "name", label: "Photograph", kind: "name", value: (photo) => photo.name },
    { key: "targets", label: "Targets", right: true, value: (photo) => photo.targets },
    { key: "rms", label: "RMS", right: true, value: (photo) => photo.rms_residual_px, show: (photo) => html`<span class="bar-cell"><meter class="bar" min="0" max=${worst} value=${photo.rms_residual_px} aria-hidden="true"></meter>${pixels(photo.rms_residual_px, 3)}</span>` },
  ];
  return html`<${Table} caption="Photographs by their residuals" columns=${columns} rows=${result.photographs} keyOf=${(photo) => photo.name} sortBy="rms" descending=${true} />`;
}

/** What a careful reader asks next. */
function Remarks({ result }) {
  const { not_carried, left_out, refused_targets } = result;
  return html`${not_carried.length > 0 && html`<${Notice} kind="warn"><p><b>Held: ${not_carried.join(", ")}.</b> These photographs tell hardly more of ${not_carried.length > 1 ? "them" : "it"} than was supposed before, so ${not_carried.length > 1 ? "they stay" : "it stays"} near that, with its uncertainty. More targets in the corners, near and far, free them. Positions do not suffer: the uncertainty is carried along.</p></${Notice}>`}
    ${left_out.length > 0 && html`<${Notice}><p><b>${plural(left_out.length, "photograph")} took no part.</b></p><ul>${left_out.map((photo) => html`<li key=${photo.name}>${photo.name}: ${photo.detail}</li>`)}</ul></${Notice}>`}
    ${refused_targets.length > 0 && html`<${Notice} kind=${refused_targets.some((target) => target.left_out) ? "warn" : ""}><p><b>Targets that do not stand where the map has them</b>, and in how many of the photographs that see them: ${refused_targets.map((target) => `${target.code} in ${target.refused} of ${target.seen}`).join(", ")}. Most photographs against one: it was moved; one of several: it was misread or half hidden there.</p></${Notice}>`}`;
}

/** Why a calibration was refused, and which photographs to add. */
export function Refusal({ error }) {
  const { advice = [], left_out = [] } = error ?? {};
  return html`<${Notice} kind="bad"><p><b>These photographs do not calibrate a camera.</b></p>
    ${advice.length ? html`<p>${error.detail.split(": ")[0]}. What helps:</p><ul>${advice.map((text) => html`<li key=${text}>${text}</li>`)}</ul>` : html`<p>${error?.detail}</p>`}
    ${left_out.length > 0 && html`<ul>${left_out.map((photo) => html`<li key=${photo.name}>${photo.name}: ${photo.detail}</li>`)}</ul>`}
    <p>The photographs stay: add better ones above and calibrate again.</p></${Notice}>`;
}
