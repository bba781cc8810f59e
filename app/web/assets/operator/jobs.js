// Jobs, the newest first: how far, how they ended; cancel, try again.
import { address, get, post } from "../core/api.js";
import { plural, time } from "../core/format.js";
import { useAction, useLoaded } from "../core/hooks.js";
import { html, useEffect, useState } from "../core/html.js";
import { Badge, Button, Empty, Failure, Field, Loaded } from "../ui/parts.js";
import { SiteLink, useSiteNames } from "./site_names.js";

const MOVING_MS = 2_000; // between two looks while something is done
const STILL_MS = 10_000; // and while nothing is
const SHOWN = 100;
const STATES = ["queued", "running", "succeeded", "failed", "cancelled"];
const KINDS = { queued: "off", running: "info", succeeded: "good", failed: "bad", cancelled: "warn" };

export function Jobs() {
  const [state, setState] = useState("");
  const jobs = useLoaded(() => get(address("/jobs", { limit: SHOWN, state: state || null })), [state]);
  const names = useSiteNames();
  const moving = jobs.data?.jobs.some((job) => ["queued", "running"].includes(job.state));
  useEffect(() => {
    const timer = setInterval(jobs.reload, moving ? MOVING_MS : STILL_MS);
    return () => clearInterval(timer);
  }, [moving, jobs.reload]);
  return html`<div style=${{ maxWidth: "14rem" }}><${Field} label="State"><select value=${state} onChange=${(event) => setState(event.target.value)}>
      <option value="">all</option>${STATES.map((name) => html`<option>${name}</option>`)}</select></${Field}></div>
    <${Loaded} of=${jobs}>${({ jobs: found }) => (found.length ? html`<${JobTable} jobs=${found} names=${names} onChange=${jobs.reload} />` : html`<${Empty}>No jobs.</${Empty}>`)}</${Loaded}>`;
}

const JobTable = ({ jobs, names, onChange }) => html`<div class="scroll" tabindex="0" role="region" aria-label="Jobs"><table>
  <thead><tr><th scope="col">State</th><th scope="col">Stage</th><th scope="col">Site</th><th scope="col">Asked for</th><th scope="col">Ended</th><th scope="col">What to do</th></tr></thead>
  <tbody>${jobs.map((job) => html`<${JobRow} key=${job.job_id} job=${job} names=${names} onChange=${onChange} />`)}</tbody></table></div>`;

function JobRow({ job, names, onChange }) {
  const open = ["queued", "running"].includes(job.state);
  const acting = useAction(async (name) => { await post(`/jobs/${job.job_id}/${name}`); onChange(); });
  return html`<tr>
    <td><${Badge} kind=${KINDS[job.state]}>${job.state}</${Badge}></td>
    <td class="text">${open ? html`${job.stage}${job.total > 0 && html`<progress max=${job.total} value=${job.done} aria-label="Progress"></progress><span class="small">${job.done} of ${plural(job.total, "piece")}</span>`}` : job.error ? job.error.detail : job.stage}</td>
    <td class="name"><${SiteLink} id=${job.site_id} names=${names} /></td>
    <td>${time(job.created_at)}</td><td>${time(job.finished_at)}</td>
    <td>${open && html`<${Button} busy=${acting.busy} onClick=${() => acting.run("cancel")}>Cancel</${Button}>`}
      ${["failed", "cancelled"].includes(job.state) && html`<${Button} busy=${acting.busy} onClick=${() => acting.run("retry")}>Try again</${Button}>`}
      <${Failure} error=${acting.error} /></td>
  </tr>`;
}
