// The numbers of an evaluation side by side: a row for each metric, a column for each system.
import { count, degrees, metres, number } from "../core/format.js";
import { html } from "../core/html.js";

const DEG = 180 / Math.PI;
const m = (value) => metres(value, 4);
const vector = (values) => values.map((value) => number(value, 4)).join(", ");
const share = (value) => (value === null ? "–" : `${(100 * value).toFixed(1)} %`);

/** With its interval, where there is one. */
const within = (interval) => (interval ? html`${m(interval.value)} <span class="muted">(${number(interval.low, 4)} to ${number(interval.high, 4)})</span>` : "–");

const GROUPS = [
  ["Errors", [
    ["Pairs", (found) => `${count(found.pairs)} of ${count(found.estimate_poses)} poses`],
    ["Mean in space", (found) => within(found.intervals_m.mean)],
    ["RMS in space", (found) => within(found.intervals_m.rms)],
    ["Median in space, SE50", (found) => within(found.intervals_m.median)],
    ["95 % in space, SE95", (found) => within(found.intervals_m.quantile_95)],
    ["RMS in the plan", ({ accuracy }) => m(accuracy.horizontal_m.rms)],
    ["Median in the plan, CE50", ({ accuracy }) => m(accuracy.CE50_m)],
    ["95 % in the plan, CE95", ({ accuracy }) => m(accuracy.CE95_m)],
    ["Median in height, VE50", ({ accuracy }) => m(accuracy.VE50_m)],
    ["95 % in height, VE95", ({ accuracy }) => m(accuracy.VE95_m)],
    ["Greatest in space", ({ accuracy }) => m(accuracy.spatial_m.greatest)],
    ["Bias x, y, z, m", ({ accuracy }) => vector(accuracy.bias_m)],
    ["RMS of x, y, z, m", ({ accuracy }) => vector(accuracy.rms_m)],
    ["Rotation, RMS", ({ accuracy }) => degrees(accuracy.rotation_rad && accuracy.rotation_rad.rms * DEG)],
  ]],
  ["Paths (SLAM)", [
    ["APE, RMS of translation", ({ pose_errors }) => m(pose_errors.absolute?.trans?.rms)],
    ["RPE over one frame", ({ pose_errors }) => m(pose_errors.relative?.frames?.trans?.rms)],
    ["RPE over one metre", ({ pose_errors }) => m(pose_errors.relative?.metres?.trans?.rms)],
    ["RPE over one second", ({ pose_errors }) => m(pose_errors.relative?.seconds?.trans?.rms)],
  ]],
  ["Service", [
    ["EvAAL score (third quartile)", ({ evaal }) => m(evaal.third_quartile_m)],
    ["Right storey", (found) => share(found.floor_detection_probability)],
    ["Available", ({ availability }) => share(availability.covered_share)],
    ["Longest silence", ({ availability }) => `${number(availability.longest_silence_s)} s`],
    ["Latency, median", ({ availability }) => (availability.latency_s ? `${number(availability.latency_s.median, 3)} s` : "–")],
  ]],
  ["Fitted", [
    ["Clock offset", ({ time_offset }) => `${number(time_offset.offset_s, 4)} s${time_offset.sigma_s ? ` ± ${number(time_offset.sigma_s, 4)} s` : ""}`],
    ["Alignment", ({ alignment }) => (alignment.kind === "none" ? "none" : `${alignment.kind}, ${count(alignment.pairs_used)} pairs`)],
    ["Shift, m", ({ alignment }) => (alignment.kind === "none" ? "–" : vector(alignment.translation_m))],
    ["Turn about z", ({ alignment }) => (alignment.kind === "none" ? "–" : degrees(Math.atan2(alignment.rotation[1][0], alignment.rotation[0][0]) * DEG, 3))],
    ["Scale", ({ alignment }) => (alignment.kind === "none" ? "–" : number(alignment.scale, 5))],
  ]],
];

/** @param {{systems: Array<{name: string, index: number, metrics: object}>}} given */
export function Metrics({ systems }) {
  const zones = [...new Set(systems.flatMap((system) => Object.keys(system.metrics.zones)))];
  const ofZones = zones.map((zone) => [`RMS in space, ${zone}`, (found) => m(found.zones[zone]?.spatial_m.rms)]);
  const groups = [...GROUPS, ...(zones.length ? [["Zones", ofZones]] : [])];
  return html`<div class="scroll" tabindex="0" role="region" aria-label="Metrics"><table class="metrics"><caption class="visually-hidden">Metrics of each system</caption>
    <thead><tr><th scope="col">Metric</th>${systems.map((system) => html`<th scope="col" class="right"><span class=${`swatch series-${(system.index % 6) + 1}`}></span>${system.name}</th>`)}</tr></thead>
    ${groups.map(([name, rows]) => html`<tbody><tr><th scope="rowgroup" colspan=${systems.length + 1}>${name}</th></tr>
      ${rows.map(([label, show]) => html`<tr><th scope="row">${label}</th>${systems.map((system) => html`<td class="right number">${show(system.metrics)}</td>`)}</tr>`)}</tbody>`)}
  </table></div>`;
}
