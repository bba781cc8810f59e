// Calibrate a phone's camera by photographs of the site's targets: choose them, see what they show, adjust, use it.
import { all, call, get, post } from "../core/api.js";
import { plural } from "../core/format.js";
import { useAction, useLoaded } from "../core/hooks.js";
import { html, useEffect, useMemo, useRef, useState } from "../core/html.js";
import { amend } from "../core/router.js";
import { may } from "../core/session.js";
import { Cameras } from "../calibration/cameras.js";
import { Coverage } from "../calibration/coverage.js";
import { FEWEST, usable } from "../calibration/measures.js";
import { Choose, Photographs } from "../calibration/photographs.js";
import { Refusal, Result } from "../calibration/result.js";
import { useDetections } from "../calibration/use_detections.js";
import { deviceId } from "../phone/device.js";
import { JobProgress } from "../ui/job.js";
import { Button, Empty, Failure, Field, Loaded, Notice } from "../ui/parts.js";

const NOTE = "photographs that calibrate a camera"; // as the service notes those that are sent with a calibration
const STAGES = { queued: "waiting for a worker", detect: "looking for targets", orient: "placing the photographs in the map", adjust: "adjusting", done: "done" };

export default function Calibration({ site: siteId, query, who }) {
  const site = useLoaded(() => get(`/sites/${siteId}`), [siteId]);
  const cameras = useLoaded(() => all("/cameras", "cameras", { site_id: siteId }), [siteId]);
  const [fresh, setFresh] = useState(undefined);
  const onCamera = (id) => { setFresh(id); cameras.reload(); };
  return html`<p class="crumbs"><a href=${`#/sites/${siteId}/phone`}>Phone</a> › Calibrate a camera</p><h1>Calibrate a camera</h1>
    <p>A phone that no survey knows is located with the focal length that EXIF tells, rounded and a few per cent off. Five to twenty photographs of this site's targets make its camera known to some hundredths of a per cent: positions get better by as much.</p>
    <${Loaded} of=${site}>${(found) => (!found.map_version ? html`<${Empty}>This site has no target map yet, and a camera is calibrated against one. <a href=${`#/sites/${siteId}/surveys`}>Survey it first</a>: that calibrates the survey's camera, too.</${Empty}>`
      : may(who, "survey") ? html`<${Wizard} site=${found} query=${query} onCamera=${onCamera} />` : html`<${Notice}>This key may look and not calibrate: that takes one with the scope survey.</${Notice}>`)}</${Loaded}>
    <${Cameras} cameras=${cameras} fresh=${fresh} who=${who} />`;
}

/** The address keeps the set of photographs and its last calibration: a closed tab loses nothing. */
function Wizard({ site, query, onCamera }) {
  const [state, setState] = useState({ surveyId: query.survey ?? null, jobId: query.job ?? null, first: [] });
  const keep = (change) => { setState((before) => ({ ...before, ...change })); };
  const filming = useState(false);
  const chosen = useRef([]); // more may come while the set is being opened
  const opening = useAction(async () => {
    const { survey_id } = await post(`/sites/${site.site_id}/surveys`, { note: NOTE });
    amend({ survey: survey_id, job: null });
    keep({ surveyId: survey_id, jobId: null, first: chosen.current });
  });
  const choose = (files) => { chosen.current.push(...files); opening.run(); };
  const start = (jobId) => { amend({ job: jobId }); keep({ jobId }); };
  const again = () => { chosen.current = []; amend({ survey: null, job: null }); keep({ surveyId: null, jobId: null, first: [] }); };
  if (!state.surveyId) return html`<${Failure} error=${opening.error} /><div class="calibration"><section class="card" aria-label="Photographs"><h2>Photographs</h2><${Choose} onFiles=${choose} filming=${filming} /></section><${Coverage} detections=${[]} picked=${null} /></div>`;
  return html`<${Set} key=${state.surveyId} site=${site} surveyId=${state.surveyId} jobId=${state.jobId} first=${state.first} filming=${filming} onStart=${start} onAgain=${again} onCamera=${onCamera} />`;
}

/** One set of photographs, from the first of them to the camera. */
function Set({ site, surveyId, jobId, first, filming, onStart, onAgain, onCamera }) {
  const photos = useLoaded(() => all(`/surveys/${surveyId}/images`, "images"), [surveyId]);
  const names = useMemo(() => (photos.data ?? []).map((photo) => photo.name), [photos.data]);
  const seen = useDetections(surveyId, names);
  const [picked, setPicked] = useState(null);
  const [result, setResult] = useState(null);
  const detections = names.flatMap((name) => seen.found.get(name) ?? []);
  const finish = (job) => { if (result?.camera_id !== job.result.camera_id) { setResult(job.result); onCamera(job.result.camera_id); } };
  return html`<div class="calibration"><${Photographs} site=${site} surveyId=${surveyId} photos=${photos} seen=${seen} first=${first} filming=${filming} result=${result} onPick=${setPicked} />
      <${Coverage} detections=${detections} picked=${picked} /></div>
    <section class="card" aria-label="Calibration"><h2>Calibrate</h2>
      <${Start} site=${site} surveyId=${surveyId} count=${usable(detections).length} onStart=${(id) => { setResult(null); onStart(id); }} onAgain=${onAgain} />
      ${jobId && html`<${JobProgress} key=${jobId} jobId=${jobId} label="Calibration progress" stages=${STAGES} onFailure=${(error) => html`<${Refusal} error=${error} />`} onSuccess=${(job) => html`<${Found} site=${site} job=${job} onFound=${finish} />`} />`}
    </section>`;
}

function Start({ site, surveyId, count, onStart, onAgain }) {
  const [device, setDevice] = useState(matchMedia("(pointer: coarse)").matches ? deviceId() : "");
  const starting = useAction(async () => {
    const form = new FormData();
    for (const [name, value] of Object.entries({ site_id: site.site_id, survey_id: surveyId, device_id: device.trim() })) if (value) form.set(name, value);
    onStart((await (await call("/cameras/calibrations", { method: "POST", body: form })).json()).job_id);
  });
  return html`<form class="row start" onSubmit=${(event) => { event.preventDefault(); starting.run(); }}>
    <${Failure} error=${starting.error} />
    <${Field} label="Phone's name" hint="As the phone calls itself on its page; empty: any phone of this model."><input maxlength="200" value=${device} onInput=${(event) => setDevice(event.target.value)} placeholder="phone-9" /></${Field}>
    <div class="row"><${Button} type="submit" kind="primary" busy=${starting.busy} disabled=${count < FEWEST}>Calibrate with ${plural(count, "photograph")}</${Button}><${Button} onClick=${onAgain}>Begin another set</${Button}></div></form>`;
}

function Found({ site, job, onFound }) {
  useEffect(() => onFound(job), [job]);
  return html`<${Notice} kind="good"><div class="row spread"><span>The camera is known now, and snapshots of ${job.result.device_id ?? "this model"} are located with it.</span>
      <a class="button primary" href=${`#/sites/${site.site_id}/phone`}>Locate with it</a></div></${Notice}>
    <${Result} result=${job.result} />`;
}
