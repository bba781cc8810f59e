// The same facts as tables: for keyboards, for screen readers, for whoever has no 3-D.
import { mm, pixels, time } from "../core/format.js";
import { html, useState } from "../core/html.js";
import { Button, Empty, Table } from "../ui/parts.js";
import { nameOf } from "./panel.js";

const POSES_A_PAGE = 200; // rows that a browser lays out at once
const AXES = ["x", "y", "z"];

const place = AXES.map((axis, index) => ({ key: axis, label: `${axis}, m`, right: true, value: (item) => item.position_m[index], show: (item) => item.position_m[index].toFixed(4) }));
const sigmas = (of) => AXES.map((axis, index) => ({ key: `s${axis}`, label: `σ${axis}, mm`, right: true, value: (item) => of(item)?.[index], show: (item) => mm(of(item)?.[index], 2).replace(" mm", "") }));
const rms = { key: "rms", label: "rms, px", right: true, value: (item) => item.rms_px, show: (item) => pixels(item.rms_px).replace(" px", "") };

const LISTS = {
  targets: { label: "Targets", sortBy: "code", columns: [{ key: "code", label: "Code", value: (item) => item.code }, ...place, ...sigmas((item) => item.sigma_m), { key: "rays", label: "Rays", right: true, value: (item) => item.rays }, rms] },
  photos: { label: "Photographs", sortBy: "name", columns: [{ key: "name", label: "Name", kind: "name", value: (item) => item.name }, ...place, ...sigmas((item) => item.position_sigma_m), { key: "targets", label: "Targets", right: true, value: (item) => item.codes?.length }, rms] },
  points: { label: "Control points", sortBy: "name", columns: [{ key: "name", label: "Name", kind: "name", value: (item) => item.name }, { key: "role", label: "Role", value: (item) => item.role }, { key: "on", label: "On", value: (item) => `${item.code} ${item.dot}` }, ...place,
    { key: "off", label: "Map − list, mm", right: true, value: (item) => item.residual_m && Math.hypot(...item.residual_m), show: (item) => (item.residual_m ? mm(Math.hypot(...item.residual_m), 2).replace(" mm", "") : "–") }] },
  poses: { label: "Poses", sortBy: "at", columns: [{ key: "at", label: "Time", value: (item) => item.at, show: (item) => time(item.at) }, { key: "of", label: "Trajectory", kind: "name", value: (item) => nameOf(item.trajectory) }, ...place, ...sigmas((item) => item.sigma_m)] },
};

/** Tabs of tables; picking a row picks the thing in the room. */
export function Lists({ room, poses, picked, onPick }) {
  const [list, setList] = useState("targets");
  const [pages, setPages] = useState(1);
  const rows = { targets: room.targets, photos: room.photos, points: room.points, poses }[list];
  const shown = list === "poses" ? rows.slice(0, pages * POSES_A_PAGE) : rows;
  return html`<div class="tabs" role="group" aria-label="Lists">${Object.entries(LISTS).map(([name, { label }]) => html`<${Button} kind="plain" aria-pressed=${name === list} onClick=${() => setList(name)}>${label} <span class="muted">${{ targets: room.targets, photos: room.photos, points: room.points, poses }[name].length}</span></${Button}>`)}</div>
    ${rows.length ? html`<${Table} key=${list} caption=${LISTS[list].label} columns=${LISTS[list].columns} rows=${shown} keyOf=${(item) => item.id} sortBy=${LISTS[list].sortBy} picked=${picked?.id} onPick=${onPick} />` : html`<${Empty}>None are shown.</${Empty}>`}
    ${shown.length < rows.length && html`<p><${Button} onClick=${() => setPages(pages + 1)}>Show more</${Button}> <span class="small muted">${shown.length} of ${rows.length} shown</span></p>`}
    ${list === "photos" && room.lost.length > 0 && html`<p class="small">Without a pose: ${room.lost.map((photo) => `${photo.name} (${photo.reason})`).join("; ")}</p>`}`;
}

/** A scale's sentence: what a length drawn in the room means for an ellipsoid. */
export const scaleLegend = (scale) => (scale === 1 ? "Ellipsoids: 1 σ, true to scale" : `Ellipsoids: 1 σ × ${scale}; 10 cm in the room are ${mm(0.1 / scale, scale > 100 ? 2 : 1)}`);
