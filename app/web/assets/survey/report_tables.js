// Residuals per photograph, target and point: tables that begin with the worst.
import { degrees, mm, number, pixels } from "../core/format.js";
import { html } from "../core/html.js";
import { Badge, Table } from "../ui/parts.js";
import { DOUBTFUL_SIGMAS, largestSigmas } from "./report_judgement.js";

const LEFT_OUT_FIRST = Infinity; // what is not in the map at all is the greatest trouble
const UNCHECKED = "–";
const useColumn = (use, kind, itemOf) => (use ? [{ key: "use", label: "Use", value: () => 0, show: (row) => use(kind, itemOf(row), String(itemOf(row))) }] : []);
const sigma = (values) => (values ? Math.hypot(...values) : null);

export function Photos({ site, surveyId, report, use }) {
  const rows = [...report.photos, ...report.photographs_left_out];
  const name = (photo) => (surveyId ? html`<a href=${`#/sites/${site.site_id}/surveys/${surveyId}/photos/${encodeURIComponent(photo.name)}`}>${photo.name}</a>` : photo.name);
  const columns = [
    ...useColumn(use, "images", (photo) => photo.name),
    { key: "name", label: "Photograph", kind: "name", value: (photo) => photo.name, show: name },
    { key: "rms", label: "Residuals, rms", right: true, value: (photo) => photo.rms_px ?? LEFT_OUT_FIRST, show: (photo) => (photo.reason === undefined ? pixels(photo.rms_px, 3) : html`<${Badge} kind="bad">not used</${Badge}>`) },
    { key: "targets", label: "Targets", right: true, value: (photo) => photo.targets ?? 0 },
    { key: "sigma", label: "Sigma of place", right: true, value: (photo) => sigma(photo.position_sigma_m), show: (photo) => mm(sigma(photo.position_sigma_m), 2) },
    ...(report.photographs_left_out.length ? [{ key: "why", label: "Why not", kind: "text", value: (photo) => photo.reason ?? "" }] : []),
  ];
  return html`<h2>Photographs</h2><${Table} caption="Photographs, the worst first" columns=${columns} rows=${rows} keyOf=${(photo) => photo.name} sortBy="rms" descending=${true} />`;
}

export function Targets({ site, report, use }) {
  const rows = [...report.targets, ...report.left_out];
  const columns = [
    ...useColumn(use, "codes", (target) => target.code),
    { key: "code", label: "Target", value: (target) => target.code, show: (target) => (target.detail === undefined ? html`<a href=${`#/sites/${site.site_id}/room?code=${target.code}`}>${target.code}</a>` : target.code) },
    { key: "sigma", label: "Sigma of place", right: true, value: (target) => sigma(target.sigma_m) ?? LEFT_OUT_FIRST, show: (target) => (target.detail === undefined ? mm(sigma(target.sigma_m), 2) : html`<${Badge} kind="bad">not in the map</${Badge}>`) },
    { key: "rms", label: "Residuals, rms", right: true, value: (target) => target.rms_px, show: (target) => pixels(target.rms_px, 3) },
    { key: "rays", label: "Rays", right: true, value: (target) => target.rays, show: (target) => target.rays ?? UNCHECKED },
    { key: "angle", label: "Angle", right: true, value: (target) => target.intersection_deg, show: (target) => degrees(target.intersection_deg, 1) },
    ...(report.left_out.length ? [{ key: "why", label: "Why not", kind: "text", value: (target) => target.detail ?? "" }] : []),
  ];
  return html`<h2>Targets</h2><${Table} caption="Targets, the worst first" columns=${columns} rows=${rows} keyOf=${(target) => `${target.code} ${target.reason ?? ""}`} sortBy="sigma" descending=${true} />`;
}

export function Points({ report, use }) {
  if (!report.control.length) return null;
  const judged = (point) => largestSigmas(point, report.targets);
  const axis = (index, label) => ({ key: label, label: `${label}, mm`, right: true, value: (point) => point.residual_m && Math.abs(point.residual_m[index]), show: (point) => (point.residual_m ? number(1000 * point.residual_m[index], 1) : UNCHECKED) });
  const columns = [
    ...useColumn(use, "control_points", (point) => point.name),
    { key: "name", label: "Point", kind: "name", value: (point) => point.name },
    { key: "role", label: "Role", value: (point) => point.role },
    { key: "target", label: "Target, dot", value: (point) => point.code, show: (point) => `${point.code} ${point.dot}` },
    axis(0, "X"), axis(1, "Y"), axis(2, "Z"),
    { key: "sigmas", label: "Largest, in sigmas", right: true, value: (point) => judged(point) ?? LEFT_OUT_FIRST, show: (point) => judgedBadge(point, judged(point)) },
  ];
  return html`<h2>Control and check points</h2><p class="small muted">Residuals: map minus what was given.</p>
    <${Table} caption="Control and check points, the worst first" columns=${columns} rows=${report.control} keyOf=${(point) => point.name} sortBy="sigmas" descending=${true} />`;
}

function judgedBadge(point, sigmas) {
  if (sigmas === null) return html`<${Badge} kind="bad">${point.residual_m ? "target not in the map" : "not seen"}</${Badge}>`;
  return sigmas > DOUBTFUL_SIGMAS ? html`<${Badge} kind="warn">${number(sigmas, 1)}</${Badge}>` : number(sigmas, 1);
}
