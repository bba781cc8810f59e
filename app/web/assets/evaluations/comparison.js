// Which system is better, beyond doubt or not; and whether the reference is good enough to tell.
import { count, metres, number } from "../core/format.js";
import { html } from "../core/html.js";
import { Badge, Notice } from "../ui/parts.js";

const OPEN = "The reference tells no uncertainty: whether it is good enough to judge these errors stays open.";

/** What each system's error means beside the reference's own uncertainty. */
export const Verdicts = ({ systems }) => (systems.every(({ metrics }) => metrics.verdict === null)
  ? html`<${Notice}><p>${OPEN}</p></${Notice}>`
  : systems.map(({ name, metrics: { verdict } }) => html`<${Verdict} name=${name} verdict=${verdict} />`));

function Verdict({ name, verdict }) {
  if (verdict === null) return html`<${Notice}><p><b>${name}:</b> ${OPEN}</p></${Notice}>`;
  return html`<${Notice} kind=${verdict.distinguishable ? "good" : "warn"}><p><b>${name}:</b> ${verdict.sentence}.
    ${verdict.distinguishable && ` Without the reference's part the system's RMS is ${metres(verdict.system_rms_m, 4)}.`}</p></${Notice}>`;
}

/** Paired differences of every two systems. */
export function Differences({ differences }) {
  if (!differences.length) return null;
  return html`<section><h2>Compared in pairs</h2><p class="muted">Mean difference of the two errors at the same moments, with its interval. An interval without zero tells them apart.</p>
    <div class="scroll" tabindex="0" role="region" aria-label="Differences"><table><thead><tr><th>First</th><th>Second</th><th class="right">Common moments</th><th class="right">First less second</th><th>Better</th></tr></thead>
    <tbody>${differences.map(({ first, second, common, mean_m, better }) => html`<tr><td class="name">${first}</td><td class="name">${second}</td><td class="right number">${count(common)}</td>
      <td class="right number">${mean_m ? html`${metres(mean_m.value, 4)} <span class="muted">(${number(mean_m.low, 4)} to ${number(mean_m.high, 4)})</span>` : "–"}</td>
      <td>${better ? html`<b class="better">${better}</b>` : html`<${Badge} kind="off">not told apart</${Badge}>`}</td></tr>`)}</tbody></table></div></section>`;
}
