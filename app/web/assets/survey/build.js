// Build the survey: options, live stage and progress, a log, cancel; then the way to the report.
import { all, post } from "../core/api.js";
import { plural } from "../core/format.js";
import { useAction, useLoaded } from "../core/hooks.js";
import { html, useState } from "../core/html.js";
import { JobProgress } from "../ui/job.js";
import { Button, Failure, Field, Notice } from "../ui/parts.js";
import { setExclusion, sizeOf, useExclusion } from "./exclusion.js";

const STAGES = { queued: "waiting for a worker", detect: "looking for targets", network: "putting photographs together", adjust: "adjusting", done: "done" };
const STRICTNESSES = [["strict", "strict: fewer targets, no doubtful one"], ["normal", "normal"], ["eager", "eager: also small and dim ones"]];
const LEAST_PHOTOGRAPHS = 2;

export function Build({ site, surveyId, names, points }) {
  const jobs = useLoaded(() => jobsOf(site.site_id, surveyId), [surveyId]);
  const [started, setStarted] = useState(null);
  const jobId = started ?? jobs.data?.[0]?.job_id;
  return html`<section class="card" aria-label="Build"><h2>Build</h2>
    <${Options} site=${site} surveyId=${surveyId} names=${names} points=${points} onStarted=${setStarted} />
    <${Failure} error=${jobs.error} />
    ${jobId && html`<${JobProgress} key=${jobId} jobId=${jobId} label="Build progress" stages=${STAGES} onSuccess=${(job) => html`<${Succeeded} site=${site} job=${job} />`} />`}</section>`;
}

/** Builds of the survey, the newest first. */
async function jobsOf(siteId, surveyId) {
  const jobs = await all("/jobs", "jobs", { site_id: siteId });
  return jobs.filter((job) => job.survey_id === surveyId);
}

function Options({ site, surveyId, names, points, onStarted }) {
  const maps = useLoaded(() => all(`/sites/${site.site_id}/maps`, "maps"), [site.site_id]);
  const [options, setOptions] = useState({ strictness: "normal", base_version: "", activate: true });
  const [exclusion] = useExclusion(surveyId);
  const exclude = known(exclusion, names, points);
  const building = useAction(async () => {
    const base_version = options.base_version === "" ? null : Number(options.base_version);
    const job = await post(`/surveys/${surveyId}/build`, { ...options, base_version, exclude });
    onStarted(job.job_id);
  });
  const set = (name) => (event) => setOptions((before) => ({ ...before, [name]: event.target.type === "checkbox" ? event.target.checked : event.target.value }));
  return html`<form class="stack" onSubmit=${(event) => { event.preventDefault(); building.run(); }}>
    <div class="columns">
      <${Field} label="Strictness" hint="How much evidence a target needs to be believed."><select value=${options.strictness} onChange=${set("strictness")}>${STRICTNESSES.map(([name, label]) => html`<option value=${name}>${label}</option>`)}</select></${Field}>
      <${Field} label="Frame" hint="Extending keeps the places of targets and of the frame."><select value=${options.base_version} onChange=${set("base_version")}><option value="">of the control points</option>
        ${(maps.data ?? []).map((map) => html`<option value=${map.map_version}>extend version ${map.map_version}</option>`)}</select></${Field}>
    </div>
    <label class="row"><input type="checkbox" checked=${options.activate} onChange=${set("activate")} /> Locate snapshots in the new version at once</label>
    <${LeftOut} surveyId=${surveyId} exclude=${exclude} />
    <${Failure} error=${building.error} />
    <div class="row"><${Button} type="submit" kind="primary" busy=${building.busy} disabled=${names.length < LEAST_PHOTOGRAPHS}>Build the target map</${Button}>
      ${names.length < LEAST_PHOTOGRAPHS && html`<span class="small muted">at least ${plural(LEAST_PHOTOGRAPHS, "photograph")} are needed</span>`}</div></form>`;
}

/** What is left out and is still there: a point may have been renamed since. */
const known = (exclusion, names, points) => ({
  ...exclusion, images: exclusion.images.filter((name) => names.includes(name)),
  control_points: exclusion.control_points.filter((name) => points.some((point) => point.name === name)),
});

export function LeftOut({ surveyId, exclude }) {
  if (!sizeOf(exclude)) return null;
  const parts = [[exclude.images, "photographs"], [exclude.codes, "targets"], [exclude.control_points, "points"]].filter(([items]) => items.length);
  return html`<${Notice} kind="warn"><div class="row spread"><span>Left out: ${parts.map(([items, word]) => `${word} ${items.join(", ")}`).join("; ")}</span>
    <${Button} onClick=${() => setExclusion(surveyId, {})}>Use all again</${Button}></div></${Notice}>`;
}

function Succeeded({ site, job }) {
  const { map_version, targets, photographs, unoriented } = job.result;
  return html`<${Notice} kind="good"><div class="row spread"><span>Version ${map_version}: ${plural(targets, "target")} of ${plural(photographs, "photograph")}${unoriented ? `, ${unoriented} of which could not be used` : ""}.</span>
    <a class="button primary" href=${`#/sites/${site.site_id}/report?version=${map_version}`}>See the report</a></div></${Notice}>`;
}
