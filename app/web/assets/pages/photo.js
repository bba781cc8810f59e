// One photograph of a survey: what was found in it, what was refused and why, and marks by hand.
import { address, all, get } from "../core/api.js";
import { pixels, plural } from "../core/format.js";
import { useLoaded } from "../core/hooks.js";
import { html, useState } from "../core/html.js";
import { amend } from "../core/router.js";
import { Badge, Field, Loaded } from "../ui/parts.js";
import { useExclusion } from "../survey/exclusion.js";
import { Marking, useMarks, useWanted, withMark } from "../survey/marking.js";
import { PhotoCanvas } from "../survey/photo_canvas.js";

const STRICTNESSES = ["strict", "normal", "eager"];
const REACH_SCREEN_PX = 30; // how far from a target's middle a click may be, beside its own size

export default function PhotoPage({ site: siteId, survey: surveyId, photo: name, query }) {
  const [strictness, setStrictness] = useState(STRICTNESSES.includes(query.strictness) ? query.strictness : "normal");
  const path = `/surveys/${surveyId}/images/${encodeURIComponent(name)}`;
  const around = useLoaded(() => surroundings(siteId, surveyId), [siteId, surveyId]);
  const detection = useLoaded((signal) => get(address(`${path}/detection`, { strictness }), { signal }), [path, strictness]);
  const choose = (event) => { setStrictness(event.target.value); amend({ strictness: event.target.value }); };
  return html`<${Loaded} of=${around}>${({ site, names, points }) => html`<${Heading} site=${site} surveyId=${surveyId} name=${name} names=${names} />
    <${Loaded} of=${detection}>${(found) => html`<${Seen} site=${site} surveyId=${surveyId} path=${path} detection=${found} points=${points} strictness=${strictness} onStrictness=${choose} />`}</${Loaded}>`}</${Loaded}>`;
}

async function surroundings(siteId, surveyId) {
  const [site, images, control] = await Promise.all([get(`/sites/${siteId}`), all(`/surveys/${surveyId}/images`, "images"), get(`/sites/${siteId}/control-points`)]);
  return { site, names: images.map((image) => image.name), points: control.control_points };
}

function Heading({ site, surveyId, name, names }) {
  const base = `#/sites/${site.site_id}/surveys/${surveyId}`;
  const at = names.indexOf(name);
  const link = (other, label) => (other ? html`<a class="button" href=${`${base}/photos/${encodeURIComponent(other)}`}>${label}</a>` : null);
  return html`<p class="crumbs"><a href=${base}>The survey</a> · photograph ${at + 1} of ${names.length}</p>
    <div class="row spread"><h1>${name}</h1><div class="row">${link(names[at - 1], "← Before")}${link(names[at + 1], "Next →")}</div></div>`;
}

function Seen({ site, surveyId, path, detection, points, strictness, onStrictness }) {
  const [show, setShow] = useState({ found: true, refused: true });
  const [picked, setPicked] = useState(null);
  const [focus, setFocus] = useState(null);
  const marking = useMarks(path);
  const { wanted, setWanted, advance } = useWanted();
  const [exclusion, change] = useExclusion(surveyId);
  const name = detection.name;
  const onMark = ([x_px, y_px]) => { marking.change(withMark({ code: Number(wanted.code), dot: wanted.dot, x_px, y_px })); advance(); };
  const onPick = (point, reach_px) => setPicked(nearest(detection, point, REACH_SCREEN_PX * reach_px));
  const look = (key, dots) => { setPicked(key); setFocus([...dots]); };
  return html`<div class="photo-work">
    <${PhotoCanvas} path=${path} detection=${detection} marks=${marking.marks ?? []} show=${show} picked=${picked} focus=${focus} marking=${wanted.active} onPick=${onPick} onMark=${onMark} />
    <aside class="card photo-side" aria-label="What was seen">
      <div class="row">${["found", "refused"].map((kind) => html`<label class="row small"><input type="checkbox" checked=${show[kind]} onChange=${() => setShow((before) => ({ ...before, [kind]: !before[kind] }))} /> <span class=${`swatch ${kind}`}></span>${kind}</label>`)}
        <label class="row small"><input type="checkbox" checked=${!exclusion.images.includes(name)} onChange=${() => change("images", name)} /> use in the next build</label></div>
      <${Field} label="Strictness"><select value=${strictness} onChange=${onStrictness}>${STRICTNESSES.map((item) => html`<option>${item}</option>`)}</select></${Field}>
      <${Found} detection=${detection} picked=${picked} look=${look} /><${Refused} detection=${detection} picked=${picked} look=${look} />
      <${Marking} site=${site} detection=${detection} marking=${marking} wanted=${wanted} setWanted=${setWanted} points=${points} />
    </aside></div>`;
}

/** What stands nearest to a point, within reach of it. */
function nearest(detection, [x, y], reach_px) {
  const size = (dots) => Math.hypot(dots[15][0] - dots[0][0], dots[15][1] - dots[0][1]) / 2;
  const candidates = [
    ...detection.targets.map((target) => ({ key: `t${target.code}`, at: middle(target.dots_px), size: size(target.dots_px) })),
    ...detection.rejected.map((refused, index) => ({ key: `r${index}`, at: refused.centre_px, size: 0 })),
  ].map((item) => ({ ...item, far: Math.hypot(item.at[0] - x, item.at[1] - y) - item.size }));
  const best = candidates.sort((a, b) => a.far - b.far)[0];
  return best && best.far <= reach_px ? best.key : null;
}

const middle = (points) => [0, 1].map((axis) => points.reduce((sum, point) => sum + point[axis], 0) / points.length);

function Found({ detection, picked, look }) {
  const targets = [...detection.targets].sort((a, b) => a.code - b.code);
  return html`<section aria-label="Found"><h2>${plural(targets.length, "target")} found</h2><ul class="seen">${targets.map((target) => html`<li key=${target.code}>
    <button type="button" aria-pressed=${picked === `t${target.code}` ? "true" : "false"} onClick=${() => look(`t${target.code}`, target.dots_px)}><b>${target.code}</b>
      <span class="small muted">${target.measured.filter(Boolean).length} dots, ${pixels(target.rms_px)}</span>
      ${target.corrected > 0 && html`<${Badge}>${target.corrected} mended</${Badge}>`} ${target.erased > 0 && html`<${Badge}>${target.erased} hidden</${Badge}>`}</button></li>`)}</ul></section>`;
}

function Refused({ detection, picked, look }) {
  if (!detection.rejected.length) return null;
  return html`<section aria-label="Refused"><h2>${detection.rejected.length} refused</h2><ul class="seen">${detection.rejected.map((refused, index) => html`<li key=${index}>
    <button type="button" aria-pressed=${picked === `r${index}` ? "true" : "false"} onClick=${() => look(`r${index}`, refused.corners_px?.length ? refused.corners_px : [refused.centre_px])}><b>${refused.code ?? refused.reason}</b>
      <span class="small muted">${refused.text}</span></button></li>`)}</ul></section>`;
}
