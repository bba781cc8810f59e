// Marks of a photograph: which dot is next, those that are set, each stored as it is set.
import { get, put } from "../core/api.js";
import { useLoaded } from "../core/hooks.js";
import { html, useEffect, useRef, useState } from "../core/html.js";
import { Button, Failure, Field } from "../ui/parts.js";
import { DOTS } from "./dots.js";
import { familyHolds } from "./families.js";

const FEWEST_MARKS = 4; // of a target that no detector saw, as the service has it

/** The marks of a photograph, `null` until they are known, and a way to change them. */
export function useMarks(path) {
  const stored = useLoaded(async (signal) => (await get(`${path}/marks`, { signal })).marks, [path]);
  const [state, setState] = useState({ marks: null, storing: false, error: null });
  const change = useRef(null);
  useEffect(() => {
    if (!stored.data) return;
    const send = (marks) => put(`${path}/marks`, { body: JSON.stringify({ marks }), headers: { "Content-Type": "application/json" } });
    change.current = keeper(stored.data, send, setState);
    setState({ marks: stored.data, storing: false, error: null });
  }, [stored.data]);
  return { ...state, error: stored.error ?? state.error, change: (edit) => change.current?.(edit) };
}

/**
 * Marks that may be set faster than they are stored: shown at once, stored one state after the other; after a failure what the service holds is shown again.
 * @param {any[]} held what the service holds
 * @param {(marks: any[]) => Promise<unknown>} send
 * @param {(state: {marks: any[], storing: boolean, error: Error | null}) => void} show
 * @returns {(edit: (marks: any[]) => any[]) => void}
 */
function keeper(held, send, show) {
  let [wanted, sending] = [held, false];
  const store = async () => {
    sending = true;
    let failure = null;
    try {
      while (held !== wanted) {
        const sent = wanted;
        await send(sent);
        held = sent;
      }
    } catch (error) {
      [wanted, failure] = [held, error];
    }
    sending = false;
    show({ marks: wanted, storing: false, error: failure });
  };
  return (edit) => {
    wanted = edit(wanted);
    show({ marks: wanted, storing: true, error: null });
    if (!sending) store();
  };
}

const isOf = (mark, { code, dot }) => mark.code === Number(code) && mark.dot === dot;

/** The marks with one more, instead of an earlier one of the same dot. */
export const withMark = (mark) => (marks) => [...marks.filter((other) => !isOf(other, mark)), mark];

/** What the next mark is of; after a mark it is the target's next dot. */
export function useWanted() {
  const [wanted, setWanted] = useState({ code: "", dot: DOTS[0], active: false });
  const advance = () => setWanted((before) => ({ ...before, dot: DOTS[(DOTS.indexOf(before.dot) + 1) % DOTS.length] }));
  return { wanted, setWanted, advance };
}

export function Marking({ site, detection, marking: { marks, storing, error, change }, wanted, setWanted, points }) {
  const set = (name) => (event) => setWanted((before) => ({ ...before, [name]: event.target.value, active: before.active && name === "dot" }));
  const valid = familyHolds(site.code_family, Number(wanted.code));
  const choose = (event) => { const point = points.find((candidate) => candidate.name === event.target.value); if (point) setWanted({ code: String(point.code), dot: point.dot, active: true }); };
  const surveyed = points.filter((point) => point.dot !== "centre");
  return html`<section aria-label="Marks"><h2>Marks by hand</h2>
    <p class="small muted">For dots that the detector missed or took wrongly. A target that it did not see needs ${FEWEST_MARKS} marks that are not in one line. The next build takes them.</p>
    <div class="mark-fields">
      ${surveyed.length > 0 && html`<${Field} label="Control point"><select value="" onChange=${choose}><option value="">choose</option>${surveyed.map((point) => html`<option value=${point.name}>${point.name}: ${point.code} ${point.dot}</option>`)}</select></${Field}>`}
      <${Field} label="Code"><input inputmode="numeric" value=${wanted.code} onInput=${set("code")} aria-invalid=${wanted.code && !valid ? "true" : null} /></${Field}>
      <${Field} label="Dot"><select value=${wanted.dot} onChange=${set("dot")}>${DOTS.map((dot) => html`<option>${dot}</option>`)}</select></${Field}>
    </div>
    ${wanted.code && !valid && html`<p class="small">${wanted.code} is no code of the family ${site.code_family}.</p>`}
    <${Button} kind=${wanted.active ? "" : "primary"} disabled=${!valid || !marks} aria-pressed=${wanted.active ? "true" : "false"} onClick=${() => setWanted((before) => ({ ...before, active: !before.active }))}>${wanted.active ? "Stop marking" : "Mark in the photograph"}</${Button}>
    ${wanted.active && html`<p class="small" role="status">Point at dot <b>${wanted.dot}</b> of <b>${wanted.code}</b> and click; on glass put a finger down, aim with the loupe, lift it.</p>`}
    <${Failure} error=${error} />
    ${marks && html`<${Placed} detection=${detection} marks=${marks} change=${change} />`}
    <p class="small muted" role="status">${storing ? "Storing…" : ""}</p></section>`;
}

function Placed({ detection, marks, change }) {
  if (!marks.length) return null;
  const short = lacking(detection, marks);
  return html`<ul class="marks" aria-label="Marks that are set">${marks.map((mark) => html`<li key=${`${mark.code} ${mark.dot}`}><span><b>${mark.code}</b> ${mark.dot} <span class="number small muted">${mark.x_px.toFixed(2)}, ${mark.y_px.toFixed(2)}</span></span>
    <${Button} kind="plain" aria-label=${`Remove ${mark.code} ${mark.dot}`} onClick=${() => change((now) => now.filter((other) => !isOf(other, mark)))}>✕</${Button}></li>`)}</ul>
    ${short.map(([code, count]) => html`<p class="small">Target ${code}: ${count} of ${FEWEST_MARKS} marks; with fewer they are not used.</p>`)}`;
}

/** Targets that no detector saw and that have too few marks yet. */
function lacking(detection, marks) {
  const seen = new Set(detection.targets.map((target) => target.code));
  const counts = new Map();
  for (const mark of marks) if (!seen.has(mark.code)) counts.set(mark.code, (counts.get(mark.code) ?? 0) + 1);
  return [...counts].filter(([, count]) => count < FEWEST_MARKS);
}
