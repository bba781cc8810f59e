// Two versions of a map: how far each target stands from where it stood before.
import { get } from "../core/api.js";
import { mm, number, plural } from "../core/format.js";
import { useLoaded } from "../core/hooks.js";
import { html, useState } from "../core/html.js";
import { Badge, Field, Figures, Loaded, Notice, Table } from "../ui/parts.js";

const NOTABLE_SIGMAS = 3;

export function Comparison({ siteId, versions, version }) {
  const others = versions.filter((item) => item.map_version !== version);
  const [chosen, setChosen] = useState(others.at(-1).map_version);
  const other = others.some((item) => item.map_version === chosen) ? chosen : others.at(-1).map_version;
  const both = useLoaded((signal) => Promise.all([other, version].map((number_) => get(`/sites/${siteId}/targets?version=${number_}`, { signal }))), [siteId, version, other]);
  return html`<section aria-label="Versions compared"><h2>Version ${version} against another</h2>
    <div class="row"><${Field} label="Compare with"><select value=${other} onChange=${(event) => setChosen(Number(event.target.value))}>${others.map((item) => html`<option value=${item.map_version}>version ${item.map_version}</option>`)}</select></${Field}></div>
    <${Loaded} of=${both}>${([before, after]) => html`<${Differences} found=${compareMaps(before, after)} />`}</${Loaded}></section>`;
}

/**
 * What differs between two maps of a site, in the frame of the site.
 * @returns {{moved: Array<{code: number, shift_m: number[], distance_m: number, sigmas: number}>, gone: number[], added: number[]}}
 */
export function compareMaps(before, after) {
  const known = new Map(before.targets.map((target) => [target.code, target]));
  const moved = after.targets.filter((target) => known.has(target.code)).map((target) => shiftOf(known.get(target.code), target));
  const present = new Set(after.targets.map((target) => target.code));
  return { moved, gone: [...known.keys()].filter((code) => !present.has(code)), added: [...present].filter((code) => !known.has(code)) };
}

function shiftOf(before, after) {
  const shift_m = after.position_m.map((value, axis) => value - before.position_m[axis]);
  const sigmas = Math.max(...shift_m.map((value, axis) => Math.abs(value) / Math.hypot(before.sigma_m[axis], after.sigma_m[axis])));
  return { code: after.code, shift_m, distance_m: Math.hypot(...shift_m), sigmas };
}

function Differences({ found }) {
  const rms_m = Math.sqrt(found.moved.reduce((sum, target) => sum + target.distance_m ** 2, 0) / Math.max(found.moved.length, 1));
  const axis = (index, label) => ({ key: label, label: `${label}, mm`, right: true, value: (target) => Math.abs(target.shift_m[index]), show: (target) => number(1000 * target.shift_m[index], 2) });
  const columns = [
    { key: "code", label: "Target", value: (target) => target.code }, axis(0, "X"), axis(1, "Y"), axis(2, "Z"),
    { key: "distance", label: "Distance", right: true, value: (target) => target.distance_m, show: (target) => mm(target.distance_m, 2) },
    { key: "sigmas", label: "In sigmas", right: true, value: (target) => target.sigmas, show: (target) => (target.sigmas > NOTABLE_SIGMAS ? html`<${Badge} kind="warn">${number(target.sigmas, 1)}</${Badge}>` : number(target.sigmas, 1)) },
  ];
  return html`<${Figures} of=${[["targets in both", found.moved.length], ["rms distance", mm(rms_m, 2)], ["largest distance", mm(Math.max(0, ...found.moved.map((target) => target.distance_m)), 2)]]} />
    ${found.added.length > 0 && html`<${Notice}>${plural(found.added.length, "target")} only in this version: ${found.added.join(", ")}.</${Notice}>`}
    ${found.gone.length > 0 && html`<${Notice} kind="warn">${plural(found.gone.length, "target")} only in the other: ${found.gone.join(", ")}.</${Notice}>`}
    <p class="small muted">This version minus the other; both are compared in the site's frame as they stand. Sigmas take the two as independent, which makes them too large where both come of the same photographs.</p>
    <${Table} caption="Differences, the largest first" columns=${columns} rows=${found.moved} keyOf=${(target) => target.code} sortBy="distance" descending=${true} />`;
}
