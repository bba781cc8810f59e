// The report's few large numbers, and what to know before signing.
import { count, mm, number, pixels, plural } from "../core/format.js";
import { html } from "../core/html.js";
import { Figures, Notice } from "../ui/parts.js";
import { largestSigmas, DOUBTFUL_SIGMAS } from "./report_judgement.js";

const LEFT_OUT = {
  moved: "in two places during the survey, or posted twice", deformed: "not as flat or as large as the others",
  rays: "seen by too few photographs that agree on the place", angle: "seen from places that stand too near together",
};

export function Summary({ report }) {
  const sigmas = report.targets.map((target) => Math.hypot(...target.sigma_m)).sort((a, b) => a - b);
  const check = report.control.filter((point) => point.role === "check" && point.residual_m).length;
  const squares = report.photos.map((photo) => photo.rms_px ** 2);
  const rms_px = squares.length ? Math.sqrt(squares.reduce((sum, value) => sum + value, 0) / squares.length) : null;
  return html`<${Figures} of=${[
    ["targets in the map", count(report.targets.length)],
    ["photographs used", `${report.photos.length} of ${report.photos.length + report.photographs_left_out.length}`],
    [`RMSE of ${plural(check, "check point")}`, mm(report.check_rmse_m)],
    ["RMSE of control points", mm(report.control_rmse_m)],
    ["median sigma of a target's place", mm(sigmas[Math.floor(sigmas.length / 2)])],
    ["residuals in the photographs, rms", pixels(rms_px, 3)],
    ["sigma0 (1 keeps what the dots promise)", number(report.sigma0)],
    ["redundancy", count(report.redundancy)],
  ]} />`;
}

/** Warnings, the grave first. */
export function Findings({ report }) {
  const grave = graveOf(report);
  const notes = notesOf(report);
  if (!grave.length && !notes.length) return html`<${Notice} kind="good">Nothing was left out and nothing contradicts the result.</${Notice}>`;
  return html`<section aria-label="Warnings"><h2>Before signing</h2>
    ${grave.map((text) => html`<${Notice} kind="warn">${text}</${Notice}>`)}${notes.map((text) => html`<${Notice}>${text}</${Notice}>`)}</section>`;
}

function graveOf(report) {
  const doubtful = report.control.filter((point) => largestSigmas(point, report.targets) > DOUBTFUL_SIGMAS).map((point) => point.name);
  const reasons = Object.keys(LEFT_OUT).map((reason) => [reason, report.left_out.filter((target) => target.reason === reason)]).filter(([, targets]) => targets.length);
  return [
    ...report.warnings,
    ...(doubtful.length ? [`${doubtful.join(", ")}: the residual is larger than the sigmas let expect. Measure again.`] : []),
    ...(report.control.some((point) => point.role === "check" && point.residual_m) ? [] : ["Nothing independent of the adjustment judges this map: give check points to know its accuracy."]),
    ...reasons.map(([reason, targets]) => `${plural(targets.length, "target")} not in the map, ${LEFT_OUT[reason]}: ${targets.map((target) => target.code).join(", ")}.`),
    ...(report.photographs_left_out.length ? [`${plural(report.photographs_left_out.length, "photograph")} could not be used; the table says why.`] : []),
  ];
}

function notesOf(report) {
  const { images, codes, control_points } = report.excluded;
  const left = [[images, "photographs"], [codes, "targets"], [control_points, "points"]].filter(([items]) => items.length);
  return [
    ...(left.length ? [`Left out on purpose: ${left.map(([items, word]) => `${word} ${items.join(", ")}`).join("; ")}.`] : []),
    ...(report.false_sightings.length ? [`${plural(report.false_sightings.length, "sighting")} that contradict the others were not used: ${report.false_sightings.map((one) => `${one.code} in ${one.photo}`).join(", ")}.`] : []),
    ...(report.extension ? [`Extends version ${report.extension.base_version}: ${plural(report.extension.added.length, "target")} added, ${report.extension.moved.length} moved.`] : []),
  ];
}
