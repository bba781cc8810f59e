// Who changed what, the newest first.
import { address, get } from "../core/api.js";
import { time } from "../core/format.js";
import { useAction, useLoaded } from "../core/hooks.js";
import { html, useState } from "../core/html.js";
import { Badge, Button, Empty, Failure, Loaded } from "../ui/parts.js";

const SHOWN = 100;
const page = (cursor) => get(address("/audit", { limit: SHOWN, cursor }));

export function Audit() {
  const first = useLoaded(() => page(null), []);
  return html`<${Loaded} of=${first}>${(found) => html`<${Entries} first=${found} key=${found.entries[0]?.entry_id} />`}</${Loaded}>`;
}

function Entries({ first }) {
  const [shown, setShown] = useState(first);
  const more = useAction(async () => {
    const next = await page(shown.next_cursor);
    setShown({ entries: [...shown.entries, ...next.entries], next_cursor: next.next_cursor });
  });
  if (!shown.entries.length) return html`<${Empty}>Nothing was changed yet.</${Empty}>`;
  return html`<div class="scroll" tabindex="0" role="region" aria-label="Audit"><table>
    <thead><tr><th scope="col">When</th><th scope="col">Who</th><th scope="col">From</th><th scope="col">What</th><th scope="col">Of</th><th scope="col">Outcome</th></tr></thead>
    <tbody>${shown.entries.map((entry) => html`<tr key=${entry.entry_id}><td>${time(entry.at)}</td><td>${entry.name}</td><td>${entry.address}</td><td><code>${entry.action}</code></td>
      <td class="small">${Object.entries(entry.subject).map(([name, value]) => html`<div>${name} <code>${value}</code></div>`)}</td>
      <td><${Badge} kind=${entry.outcome === "done" ? "good" : "warn"}>${entry.outcome}</${Badge}></td></tr>`)}</tbody></table></div>
    <${Failure} error=${more.error} />${shown.next_cursor && html`<${Button} busy=${more.busy} onClick=${() => more.run()}>Older</${Button}>`}`;
}
