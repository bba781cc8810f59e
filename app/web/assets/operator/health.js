// Whether the service can do its work now, check by check.
import { useLoaded } from "../core/hooks.js";
import { html, useEffect } from "../core/html.js";
import { Badge, Facts, Loaded } from "../ui/parts.js";

const EVERY_MS = 10_000;
const KINDS = { ready: "good", degraded: "warn" };

export function Health() {
  const health = useLoaded(look, []);
  useEffect(() => {
    const timer = setInterval(health.reload, EVERY_MS);
    return () => clearInterval(timer);
  }, [health.reload]);
  return html`<${Loaded} of=${health}>${(found) => html`<section class="card">
    <h2>This server is <${Badge} kind=${KINDS[found.status] || "bad"}>${found.status}</${Badge}></h2>
    <${Facts} of=${Object.entries(found.checks).map(([name, outcome]) => [name.replaceAll("_", " "), outcome === "ok" ? html`<${Badge} kind="good">ok</${Badge}>` : html`<${Badge} kind="bad">wrong</${Badge}> ${outcome}`])} />
    <p class="small muted">Looked at every ten seconds. For machines: <a href="/readyz">/readyz</a>, <a href="/metrics">/metrics</a>.</p>
  </section>`}</${Loaded}>`;
}

/** The answer tells what is wrong with status 503, too: that is no failure of the call. */
async function look(signal) {
  const answer = await fetch("/readyz", { signal });
  const found = await answer.json();
  if (!found.checks) throw new Error(found.detail || `the server answered ${answer.status}`);
  return found;
}
