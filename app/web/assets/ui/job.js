// A job of the service as it goes on: its stage and progress live, a log, cancel, and what came of it.
import { get, post } from "../core/api.js";
import { time } from "../core/format.js";
import { useAction } from "../core/hooks.js";
import { html, useEffect, useState } from "../core/html.js";
import { listen } from "../core/listen.js";
import { Badge, Button, Failure, Notice } from "./parts.js";

const ENDED = ["succeeded", "failed", "cancelled"];
const KINDS = { queued: "off", running: "info", succeeded: "good", failed: "bad", cancelled: "warn" };

/**
 * @param {object} given
 * @param {string} given.jobId
 * @param {string} given.label what it is, for those who do not see it
 * @param {Record<string, string>} given.stages what each stage is in words
 * @param {(job: object) => any} given.onSuccess what is shown of its result
 * @param {(error: object) => any} [given.onFailure] what is shown of its error
 */
export function JobProgress({ jobId, label, stages, onSuccess, onFailure = (error) => html`<${Notice} kind="bad"><p>${error?.detail}</p></${Notice}>` }) {
  const { job, log, connected, error } = useJob(jobId, stages);
  const cancelling = useAction(() => post(`/jobs/${jobId}/cancel`));
  if (!job) return html`<${Failure} error=${error} />`;
  const running = !ENDED.includes(job.state);
  return html`<div class="job-progress" role="status" aria-label=${label}>
    <div class="row spread"><span><${Badge} kind=${KINDS[job.state]}>${job.state}</${Badge}> ${running && (stages[job.stage] ?? job.stage)} ${running && job.total > 1 && html`<span class="number">${job.done} of ${job.total}</span>`}</span>
      ${running && html`<${Button} busy=${cancelling.busy} onClick=${cancelling.run}>Cancel</${Button}>`}</div>
    ${running && html`<progress max=${job.total || 1} value=${job.total ? job.done : null} aria-label="Stage"></progress>`}
    ${running && !connected && html`<p class="small muted">The connection is lost; the work goes on, and this page looks again.</p>`}
    <${Failure} error=${cancelling.error} />
    ${job.state === "failed" && onFailure(job.error)}
    ${job.state === "succeeded" && onSuccess(job)}
    <details><summary class="small">Log</summary><ol class="small log">${log.map((line) => html`<li key=${line.stage}>${line.text}</li>`)}</ol></details>
  </div>`;
}

/** A job by its events, from now to its end. */
function useJob(jobId, stages) {
  const [state, setState] = useState({ job: null, log: [], connected: true, error: null });
  useEffect(() => {
    const told = (before, job) => ({ ...before, job, log: logged(before.log, job, stages), error: null });
    const take = (job) => { setState((before) => told(before, job)); if (ENDED.includes(job.state)) close(); };
    const close = listen(`/jobs/${jobId}/events`, { message: take }, (connected) => setState((before) => ({ ...before, connected })));
    get(`/jobs/${jobId}`).then((job) => setState((before) => (before.job ? before : told(before, job))), (error) => setState((before) => ({ ...before, error })));
    return close;
  }, [jobId]);
  return state;
}

/** The log with the job's present stage as its last line. */
function logged(log, job, stages) {
  const stage = ENDED.includes(job.state) ? job.state : job.stage || job.state;
  const at = ENDED.includes(job.state) ? job.finished_at : new Date().toISOString();
  const progress = job.total > 1 && !ENDED.includes(job.state) ? `, ${job.done} of ${job.total}` : "";
  const text = `${time(at)}: ${stages[stage] ?? stage}${progress}`;
  return log.at(-1)?.stage === stage ? [...log.slice(0, -1), { stage, text }] : [...log, { stage, text }];
}
