// The answer to the newest picture: large enough to read at arm's length, and said aloud to those who do not see it.
import { degrees, mm, number, pixels, plural } from "../core/format.js";
import { html } from "../core/html.js";
import { Busy } from "../ui/parts.js";
import { poseOf } from "../trajectories/poses.js";
import { adviceFor } from "./advice.js";

const AXES = ["x", "y", "z"];
const CLOCK = new Intl.DateTimeFormat(undefined, { timeStyle: "medium" });
const inDegrees = (radians) => (radians === null ? null : (radians * 180) / Math.PI);

/** @param {object | null} result the newest of the queue's; `waiting`: another one is on its way */
export function Answer({ result, site, waiting }) {
  return html`<section class="card phone-answer" aria-label="Position" aria-live="polite" aria-atomic="true">
    ${waiting && html`<span class="phone-sending"><${Busy} /></span>`}
    ${!result ? html`<p class="phone-headline muted">No position yet.</p><p class="small muted">Point the camera at the targets, then locate.</p>`
      : result.answer ? html`<${Position} answer=${result.answer} />` : html`<${Refusal} problem=${result.problem} captured_ms=${result.captured_ms} site=${site} />`}
  </section>`;
}

function Position({ answer }) {
  const pose = poseOf(answer);
  const used = answer.targets.filter((target) => target.used).length;
  return html`<dl class="phone-position">${AXES.map((axis, index) => html`<div><dt>${axis}, m</dt><dd><b>${number(pose.position_m[index], 3)}</b><span>± ${mm(pose.sigma_m[index])}</span></dd></div>`)}</dl>
    <p class="phone-facts"><span>Heading <b>${degrees(inDegrees(pose.heading_rad), 1)}</b>${pose.heading_sigma_rad !== null && html` <span class="muted">± ${degrees(inDegrees(pose.heading_sigma_rad))}</span>`}</span>
      <span><b>${used}</b> of ${plural(answer.targets.length, "target")}</span>
      <span>residuals <b>${pixels(answer.rms_residual_px)}</b></span><span>σ₀ <b>${number(answer.sigma0)}</b></span></p>
    <p class="small muted">${CLOCK.format(new Date(answer.captured_at))} · camera: ${CAMERA_SOURCES[answer.camera_source]} · map version ${answer.map_version}</p>`;
}

const CAMERA_SOURCES = {
  survey: "as the survey found it", calibration: "as it was calibrated", client: "as this page said", exif: "as the photograph's file says", model: "like another of its kind",
};

function Refusal({ problem, captured_ms, site }) {
  const advice = adviceFor(problem);
  return html`<p class="phone-headline bad">${advice.headline}</p>
    <p>${problem.detail}</p>
    ${advice.camera && html`<p><a href=${`#/sites/${site}/phone/calibration`}>Calibrate this camera</a>, or take the photograph with the phone's own camera app: its file says how it was taken.</p>`}
    ${captured_ms && html`<p class="small muted">${CLOCK.format(captured_ms)} · not located</p>`}`;
}
