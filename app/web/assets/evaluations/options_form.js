// The options of a comparison, as people set them and as POST /evaluations takes them.
import { html } from "../core/html.js";
import { Field } from "../ui/parts.js";

/** What the form begins with: the service's own defaults. */
export const DEFAULTS = {
  association: "interpolate", max_gap_s: "1", course: "linear", clock: "known", time_offset_s: "0", alignment: "none", first_n: "10",
  rotation_from: "positions", lever_arm: "", floor_height_m: "", zones: "", confidence: "95", resamples: "2000",
};

const ASSOCIATIONS = { interpolate: "interpolate the reference", nearest: "nearest stamp", last: "last word before each pose (EvAAL)" };
const ALIGNMENTS = { none: "none: the system knows the site's frame", posyaw: "heading and shift", se3: "rotation and shift", sim3: "rotation, shift and scale", origin: "the first pair", first_n: "the first pairs" };

/**
 * The options as the service takes them.
 * @throws {Error} that says which field is not understood
 */
export function optionsOf(form) {
  return {
    association: form.association,
    max_gap_s: Number(form.max_gap_s),
    course: form.course,
    time_offset_s: form.clock === "estimate" ? "estimate" : Number(form.time_offset_s),
    alignment: form.alignment,
    first_n: Number(form.first_n),
    rotation_from: form.rotation_from,
    lever_arm_m: form.lever_arm.trim() ? armOf(form.lever_arm) : null,
    floor_height_m: form.floor_height_m ? Number(form.floor_height_m) : null,
    zones: form.zones.trim() ? zonesOf(form.zones) : [],
    bootstrap: { confidence: Number(form.confidence) / 100, resamples: Number(form.resamples) },
  };
}

function armOf(text) {
  const numbers = text.trim().split(/[\s,;]+/).map(Number);
  if (numbers.length !== 3 || !numbers.every(Number.isFinite)) throw new Error(`the lever arm is three numbers in metres, right, down, forward; got "${text}"`);
  return numbers;
}

function zonesOf(text) {
  return text.trim().split("\n").map((line, index) => {
    const [name, corners] = line.split(":");
    const corners_m = (corners ?? "").trim().split(/\s+/).map((corner) => corner.split(",").map(Number));
    if (corners_m.length < 3 || !corners_m.every((corner) => corner.length === 2 && corner.every(Number.isFinite))) throw new Error(`line ${index + 1} of the zones is no "name: x,y x,y x,y"; got "${line}"`);
    return { name: name.trim(), corners_m };
  });
}

/** @param {{form: object, change: (name: string) => (event: Event) => void}} given */
export function OptionsForm({ form, change }) {
  const number = (name, more = {}) => html`<input type="number" step="any" value=${form[name]} onInput=${change(name)} ...${more} />`;
  const choice = (name, labels) => html`<select value=${form[name]} onChange=${change(name)}>${Object.entries(labels).map(([value, label]) => html`<option value=${value}>${label}</option>`)}</select>`;
  return html`<div class="columns">
    <${Field} label="Association">${choice("association", ASSOCIATIONS)}</${Field}>
    <${Field} label="Largest gap, s">${number("max_gap_s", { min: 0 })}</${Field}>
    <${Field} label="Between reference poses">${choice("course", { linear: "a straight line", spline: "a spline" })}</${Field}>
    <${Field} label="Clock offset">${choice("clock", { known: "known", estimate: "estimated from the walks" })}</${Field}>
    ${form.clock === "known" && html`<${Field} label="Reference's clock less the system's, s">${number("time_offset_s")}</${Field}>`}
    <${Field} label="Alignment" hint="Align only what the system cannot know.">${choice("alignment", ALIGNMENTS)}</${Field}>
    ${form.alignment === "first_n" && html`<${Field} label="So many pairs">${number("first_n", { min: 3, step: 1 })}</${Field}>`}
    ${form.alignment !== "none" && html`<${Field} label="Rotation from">${choice("rotation_from", { positions: "positions", orientations: "orientations" })}</${Field}>`}
    <${Field} label="Lever arm, m" hint="Camera to antenna: right, down, forward."><input value=${form.lever_arm} onInput=${change("lever_arm")} placeholder="none" /></${Field}>
    <${Field} label="Storey height, m" hint="Tells storeys where they are not told.">${number("floor_height_m", { min: 0.1, placeholder: "none" })}</${Field}>
    <${Field} label="Confidence of intervals, %">${number("confidence", { min: 50, max: 99.9 })}</${Field}>
    <${Field} label="Resamples">${number("resamples", { min: 100, max: 10000, step: 1 })}</${Field}>
    <${Field} label="Zones" hint="One a line: name: x,y x,y x,y"><textarea rows="3" value=${form.zones} onInput=${change("zones")}></textarea></${Field}>
  </div>`;
}
