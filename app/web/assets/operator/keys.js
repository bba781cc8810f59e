// Keys: made once shown, listed without their secret, revoked.
import { all, post, remove } from "../core/api.js";
import { time } from "../core/format.js";
import { useAction, useLoaded } from "../core/hooks.js";
import { html, useState } from "../core/html.js";
import { Badge, Button, Dialog, Empty, Failure, Field, Loaded, Notice, Table } from "../ui/parts.js";

const SCOPES = [
  ["locate", "locate: a phone that sends snapshots"],
  ["survey", "survey: photographs, control points, target maps"],
  ["analyse", "analyse: trajectories and evaluations"],
  ["admin", "admin: all of these, and keys"],
];

export function Keys() {
  const keys = useLoaded(() => all("/keys", "keys"), []);
  const sites = useLoaded(() => all("/sites", "sites"), []);
  const [making, setMaking] = useState(false);
  return html`<div class="row spread"><p>A key is shown once, when it is made. Without any key the service answers on this machine alone.</p>
      <${Button} kind="primary" onClick=${() => setMaking(true)}>New key</${Button}></div>
    <${Loaded} of=${keys}>${(found) => (found.length ? html`<${KeyTable} keys=${found} onChange=${keys.reload} />` : html`<${Empty}>No keys.</${Empty}>`)}</${Loaded}>
    ${making && html`<${NewKey} sites=${sites.data || []} onMade=${keys.reload} onClose=${() => setMaking(false)} />`}`;
}

const stateOf = (key) => (key.revoked_at ? ["bad", "revoked"] : key.expires_at && new Date(key.expires_at) < new Date() ? ["warn", "expired"] : ["good", "valid"]);

function KeyTable({ keys, onChange }) {
  const columns = [
    { key: "name", label: "Name", kind: "name", value: (key) => key.name },
    { key: "hint", label: "Begins with", value: (key) => key.hint, show: (key) => html`<code>${key.hint}…</code>` },
    { key: "scopes", label: "May", value: (key) => key.scopes.join(", ") },
    { key: "sites", label: "Sites", value: (key) => (key.site_ids ? key.site_ids.length : Infinity), show: (key) => (key.site_ids ? key.site_ids.length : "all") },
    { key: "state", label: "State", value: (key) => stateOf(key)[1], show: (key) => html`<${Badge} kind=${stateOf(key)[0]}>${stateOf(key)[1]}</${Badge}>` },
    { key: "used", label: "Last used", value: (key) => key.last_used_at, show: (key) => time(key.last_used_at) },
    { key: "expires", label: "Expires", value: (key) => key.expires_at, show: (key) => (key.expires_at ? time(key.expires_at) : "never") },
    { key: "do", label: "What to do", value: () => "", show: (key) => !key.revoked_at && html`<${Revoke} apiKey=${key} onDone=${onChange} />` },
  ];
  return html`<${Table} caption="Keys" columns=${columns} rows=${keys} keyOf=${(key) => key.key_id} sortBy="name" />`;
}

function Revoke({ apiKey, onDone }) {
  const [asked, setAsked] = useState(false);
  const revoking = useAction(async () => { await remove(`/keys/${apiKey.key_id}`); setAsked(false); onDone(); });
  return html`<${Button} kind="danger" onClick=${() => setAsked(true)} aria-label=${`Revoke ${apiKey.name}`}>Revoke</${Button}>
    ${asked && html`<${Dialog} title=${`Revoke ${apiKey.name}`} onClose=${() => setAsked(false)}><p>Whoever uses it is shut out within seconds. This cannot be undone; another key can be made.</p>
      <${Failure} error=${revoking.error} /><${Button} kind="danger" busy=${revoking.busy} onClick=${() => revoking.run()}>Revoke it</${Button}></${Dialog}>`}`;
}

function NewKey({ sites, onMade, onClose }) {
  const [form, setForm] = useState({ name: "", scopes: ["locate"], site: "", days: "" });
  const [secret, setSecret] = useState(null);
  const change = (name) => (event) => setForm((before) => ({ ...before, [name]: event.target.value }));
  const turn = (scope) => () => setForm((before) => ({ ...before, scopes: before.scopes.includes(scope) ? before.scopes.filter((other) => other !== scope) : [...before.scopes, scope] }));
  const making = useAction(async () => {
    const made = await post("/keys", { name: form.name, scopes: form.scopes, site_ids: form.site ? [form.site] : null, expires_at: form.days ? inDays(form.days) : null });
    setSecret(made.secret);
    onMade();
  });
  if (secret) return html`<${Made} secret=${secret} onClose=${onClose} />`;
  return html`<${Dialog} title="New key" onClose=${onClose}><form class="stack" onSubmit=${(event) => { event.preventDefault(); making.run(); }}>
    <${Failure} error=${making.error} />
    <${Field} label="Name" hint="Who or what uses it; it stands in the log."><input required maxlength="200" value=${form.name} onInput=${change("name")} /></${Field}>
    <fieldset><legend>May</legend>${SCOPES.map(([scope, label]) => html`<label class="row"><input type="checkbox" checked=${form.scopes.includes(scope)} onChange=${turn(scope)} /> ${label}</label>`)}</fieldset>
    <${Field} label="Site"><select value=${form.site} onChange=${change("site")}><option value="">all sites</option>${sites.map((site) => html`<option value=${site.site_id}>${site.name}</option>`)}</select></${Field}>
    <${Field} label="Days that it lasts" hint="Empty: until it is revoked."><input type="number" min="1" max="3650" value=${form.days} onInput=${change("days")} /></${Field}>
    <div><${Button} type="submit" kind="primary" busy=${making.busy} disabled=${!form.scopes.length}>Make the key</${Button}></div></form></${Dialog}>`;
}

/** The secret, once. Browsers lend their clipboard to secure pages only: elsewhere it is copied by hand. */
function Made({ secret, onClose }) {
  const copying = useAction(async () => { await navigator.clipboard.writeText(secret); return true; });
  const [copied, setCopied] = useState(false);
  return html`<${Dialog} title="The new key" onClose=${onClose}><${Notice} kind="good"><p>Copy it now: it is not shown again.</p></${Notice}><p><code data-testid="secret">${secret}</code></p>
    <${Failure} error=${copying.error} />
    <div class="row">${navigator.clipboard && html`<${Button} onClick=${async () => setCopied(Boolean(await copying.run()))}>Copy</${Button}>`}<span class="small muted" role="status">${copied ? "Copied." : ""}</span></div></${Dialog}>`;
}

const inDays = (days) => new Date(Date.now() + Number(days) * 86_400_000).toISOString();
