// The pose that is pointed at, in numbers; failures by name.
import { count, degrees, metres, mm, time } from "../core/format.js";
import { html } from "../core/html.js";
import { useValueOf } from "../ui/shared_value.js";
import { Facts, Table } from "../ui/parts.js";

const DEG = 180 / Math.PI;

export function Readout({ poses, pointer }) {
  const index = useValueOf(pointer);
  const pose = poses[index ?? -1];
  return html`<section class="card readout" aria-label="Pose" aria-live="polite"><h2>Pose</h2>
    ${pose ? html`<${Facts} of=${factsOf(pose)} />` : html`<p class="muted">Point at the plan or at a curve, or go with the arrow keys from pose to pose.</p>`}</section>`;
}

const withSigma = (text, sigma) => html`<span class="number">${text}${sigma && html` <span class="muted">± ${sigma}</span>`}</span>`;

const factsOf = (pose) => [
  ["Time", time(new Date(pose.time_s * 1000).toISOString())],
  ...["x", "y", "z"].map((name, row) => [name, withSigma(metres(pose.position_m[row]), pose.sigma_m && mm(pose.sigma_m[row]))]),
  ["Heading", withSigma(degrees(pose.heading_rad && pose.heading_rad * DEG), pose.heading_sigma_rad && degrees(pose.heading_sigma_rad * DEG))],
  ["Number", count(pose.ordinal)],
];

const columns = [
  { key: "time", label: "Time", value: (failure) => failure.time_s, show: (failure) => time(failure.captured_at) },
  { key: "reason", label: "Reason", value: (failure) => failure.reason },
  { key: "detail", label: "What happened", kind: "text", value: (failure) => failure.detail },
  { key: "advice", label: "What to do", kind: "text", value: (failure) => failure.advice },
];

export const Failures = ({ failures }) => html`<section><h2>Failures</h2><${Table} caption="Failures" columns=${columns} rows=${failures} keyOf=${(failure) => failure.ordinal} sortBy="time" /></section>`;
