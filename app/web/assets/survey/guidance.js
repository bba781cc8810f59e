// What the survey lacks, beside its photographs; asked again while photographs are looked at.
import { get, laterOf } from "../core/api.js";
import { degrees, plural } from "../core/format.js";
import { html, useEffect, useState } from "../core/html.js";
import { Badge, Busy, Failure } from "../ui/parts.js";

const AGAIN_AFTER_MS = 2500;
const STATES = { good: ["good", "good"], "few-rays": ["too few photographs", "warn"], narrow: ["seen from one side", "warn"], apart: ["hangs together with none", "bad"], unseen: ["in no photograph", "bad"] };

export function Guidance({ site, surveyId, version, onFound }) {
  const { guidance, error } = useGuidance(surveyId, version, onFound);
  return html`<aside class="card guidance" aria-label="Guidance"><h2>What is lacking</h2>
    <${Failure} error=${error} />
    ${guidance ? html`<${Found} site=${site} guidance=${guidance} />` : !error && html`<p><${Busy} /> looking</p>`}</aside>`;
}

/** Guidance, asked for again whenever `version` changes and while photographs wait to be looked at. */
function useGuidance(surveyId, version, onFound) {
  const [state, setState] = useState({ guidance: null, error: null });
  useEffect(() => {
    const controller = new AbortController();
    let timer = 0;
    const ask = async () => {
      try {
        const guidance = await get(`/surveys/${surveyId}/guidance`, { signal: controller.signal });
        setState({ guidance, error: null });
        onFound(guidance);
        if (guidance.pending) timer = setTimeout(ask, AGAIN_AFTER_MS);
      } catch (error) {
        if (error.name === "AbortError") return;
        const later_s = laterOf(error);
        if (!later_s) setState((before) => ({ ...before, error }));
        timer = setTimeout(ask, later_s ? 1000 * later_s : 2 * AGAIN_AFTER_MS);
      }
    };
    ask();
    return () => { controller.abort(); clearTimeout(timer); };
  }, [surveyId, version]);
  return state;
}

function Found({ guidance }) {
  const lacking = guidance.targets.filter((target) => target.state !== "good");
  const good = guidance.targets.length - lacking.length;
  return html`<p role="status">${guidance.summary}</p>
    ${guidance.pending > 0 && html`<p class="small muted"><${Busy} /> ${plural(guidance.pending, "photograph")} still to be looked at</p>`}
    ${guidance.targets.length > 0 && html`<progress max=${guidance.targets.length} value=${good} aria-label="Targets that would be published now"></progress><p class="small muted">${good} of ${plural(guidance.targets.length, "target")} would be published now</p>`}
    ${guidance.next_shot && html`<div class="notice"><p><b>Best next photograph</b> (helps ${plural(guidance.next_shot.codes.length, "target")}): ${guidance.next_shot.shot.text}</p></div>`}
    ${lacking.length > 0 && html`<details open=${lacking.length <= 6}><summary>${plural(lacking.length, "target")} to look after</summary><ul class="lacking">${lacking.map((target) => html`<li key=${target.code}>
      <b>${target.code}</b> <${Badge} kind=${STATES[target.state][1]}>${STATES[target.state][0]}</${Badge}>
      <span class="small muted">${plural(target.rays, "ray")}${target.angle_deg === null ? "" : `, ${degrees(target.angle_deg, 0)}`}</span>
      <p class="small">${target.advice}</p></li>`)}</ul></details>`}`;
}
