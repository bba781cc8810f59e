// Choose a reference, one or several systems, and how they are compared.
import { post } from "../core/api.js";
import { count } from "../core/format.js";
import { useAction } from "../core/hooks.js";
import { html, useState } from "../core/html.js";
import { go } from "../core/router.js";
import { nameOf } from "../trajectories/texts.js";
import { Button, Empty, Failure, Field } from "../ui/parts.js";
import { DEFAULTS, OptionsForm, optionsOf } from "./options_form.js";

/** @param {{trajectories: object[], reference?: string, chosen: string[], onChosen: (ids: string[]) => void}} given */
export function Compare({ trajectories, reference, chosen, onChosen }) {
  const usable = trajectories.filter((item) => item.pose_count > 0);
  const [form, setForm] = useState({ ...DEFAULTS, title: "", reference: reference ?? "" });
  const change = (name) => (event) => setForm((before) => ({ ...before, [name]: event.target.value }));
  const against = usable.some((item) => item.trajectory_id === form.reference) ? form.reference : (usable.find((item) => !item.source) ?? usable[0])?.trajectory_id;
  const estimates = chosen.filter((id) => id !== against);
  const comparing = useAction(async () => {
    const made = await post("/evaluations", { reference_id: against, estimate_ids: estimates, title: form.title || null, options: optionsOf(form) });
    go(`#/evaluations/${made.evaluation_id}`);
  });
  const toggle = (id) => onChosen(chosen.includes(id) ? chosen.filter((other) => other !== id) : [...chosen, id]);
  if (usable.length < 2) return html`<section class="card"><h2>Compare</h2><${Empty}>A comparison takes two trajectories: a reference, usually one that a phone walked, and a system's.</${Empty}></section>`;
  return html`<section class="card" aria-label="Compare"><h2>Compare</h2>
    <form class="stack" onSubmit=${(event) => { event.preventDefault(); comparing.run(); }}>
      <${Field} label="Reference"><select value=${against} onChange=${change("reference")}>${usable.map((item) => html`<option value=${item.trajectory_id}>${labelOf(item)}</option>`)}</select></${Field}>
      <fieldset><legend>Systems</legend><div class="systems">${usable.filter((item) => item.trajectory_id !== against).map((item) => html`<label class="row small"><input type="checkbox" checked=${chosen.includes(item.trajectory_id)} onChange=${() => toggle(item.trajectory_id)} />${labelOf(item)}</label>`)}</div></fieldset>
      <${Field} label="Title"><input maxlength="200" value=${form.title} onInput=${change("title")} placeholder="the systems' names" /></${Field}>
      <details><summary>Options</summary><${OptionsForm} form=${form} change=${change} /></details>
      <${Failure} error=${comparing.error} />
      <div><${Button} type="submit" kind="primary" busy=${comparing.busy} disabled=${!estimates.length}>Compare</${Button}></div>
    </form></section>`;
}

const labelOf = (item) => `${nameOf(item)} (${count(item.pose_count)} poses, ${item.source ? item.source.format : "located"})`;
