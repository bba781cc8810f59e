// What the reader chooses: the view, the version, what is drawn and how large.
import { count } from "../core/format.js";
import { html } from "../core/html.js";
import { Button, Field } from "../ui/parts.js";
import { SCALES } from "./ellipsoids.js";
import { scaleLegend } from "./lists.js";
import { nameOf } from "./panel.js";
import { VIEWS } from "./views.js";
import { DIRECTIONS } from "./walk.js";

const ARROWS = { forward: "↑", back: "↓", left: "←", right: "→" };

export const Views = ({ view, onView, onStep }) => html`<div class="views" role="group" aria-label="View">
  ${Object.entries(VIEWS).map(([name, { label }]) => html`<${Button} aria-pressed=${view === name} onClick=${() => onView(name)}>${label}</${Button}>`)}
  <${Button} onClick=${() => onView(view)} disabled=${view === "walk"}>Fit all</${Button}>
  ${view === "walk" && html`<span class="steps" role="group" aria-label="Steps">${Object.keys(DIRECTIONS).map((name) => html`<${Button} aria-label=${`Step ${name}`} onClick=${() => onStep(name)}>${ARROWS[name]}</${Button}>`)}</span>`}
</div>`;

export const Versions = ({ room, onVersion }) => html`<${Field} label="Version"><select value=${room.version} onChange=${(event) => onVersion(Number(event.target.value))}>
  ${room.versions.map((one) => html`<option value=${one.map_version}>${one.map_version}${one.active ? " (in use)" : ""}, ${one.targets} targets</option>`)}</select></${Field}>`;

const LAYERS = [["codes", "Codes"], ["ellipsoids", "Ellipsoids"], ["photos", "Photographs"], ["points", "Control points"], ["poses", "Poses"], ["grid", "Grid and axes"]];

/** Which kinds of things are drawn. */
export const Layers = ({ visible, onVisible }) => html`<fieldset class="layers"><legend>Drawn</legend>
  ${LAYERS.map(([name, label]) => html`<label><input type="checkbox" checked=${visible[name]} onChange=${(event) => onVisible({ ...visible, [name]: event.target.checked })} /> <span class="sign ${name}"></span>${label}</label>`)}</fieldset>`;

/** How large ellipsoids are drawn, and whether with what all targets share. */
export const Scale = ({ scale, onScale, withDatum, onDatum }) => html`<fieldset><legend>Ellipsoids</legend>
  <label class="field"><span class="visually-hidden">Enlarged by</span><input type="range" aria-label="Ellipsoids enlarged by" min="0" max=${SCALES.length - 1} step="1" value=${scale} aria-valuetext=${`${SCALES[scale]} times`} onInput=${(event) => onScale(Number(event.target.value))} /></label>
  <p class="small" data-testid="scale">${scaleLegend(SCALES[scale])}</p>
  <label class="small"><input type="checkbox" checked=${withDatum} onChange=${(event) => onDatum(event.target.checked)} /> with the datum's part, which all targets share</label></fieldset>`;

/** Whose poses are drawn. */
export const Trajectories = ({ trajectories, chosen, onChosen, loading }) => trajectories.length > 0 && html`<fieldset class="layers"><legend>Trajectories${loading ? " (loading)" : ""}</legend>
  ${trajectories.map((one, index) => html`<label><input type="checkbox" checked=${chosen.has(one.trajectory_id)} onChange=${() => onChosen(toggled(chosen, one.trajectory_id))} /> <span class="sign series-${1 + (index % 6)}"></span>${nameOf(one)} <span class="muted">${count(one.pose_count)}</span></label>`)}</fieldset>`;

function toggled(chosen, id) {
  const after = new Set(chosen);
  if (!after.delete(id)) after.add(id);
  return after;
}
