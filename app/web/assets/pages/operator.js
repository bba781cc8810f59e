// For whoever runs the service: is it well, what is it doing, what fills the disk, who holds keys, who changed what.
import { html, useState } from "../core/html.js";
import { amend } from "../core/router.js";
import { may } from "../core/session.js";
import { Audit } from "../operator/audit.js";
import { Health } from "../operator/health.js";
import { Jobs } from "../operator/jobs.js";
import { Keys } from "../operator/keys.js";
import { Storage } from "../operator/storage.js";
import { Notice } from "../ui/parts.js";

const PARTS = [
  { part: "health", label: "Health", view: Health },
  { part: "jobs", label: "Jobs", view: Jobs },
  { part: "storage", label: "Storage", view: Storage, scope: "admin" },
  { part: "keys", label: "Keys", view: Keys, scope: "admin" },
  { part: "audit", label: "Audit", view: Audit, scope: "admin" },
];

export default function Operator({ who, query }) {
  const [part, setPart] = useState(PARTS.some((item) => item.part === query.part) ? query.part : PARTS[0].part);
  const shown = PARTS.filter((item) => !item.scope || may(who, item.scope));
  const View = shown.find((item) => item.part === part)?.view;
  const choose = (name) => (event) => { event.preventDefault(); amend({ part: name }); setPart(name); };
  return html`<h1>Operator</h1>
    <nav class="tabs" aria-label="Operator">${shown.map((item) => html`<a href=${`#/operator?part=${item.part}`} onClick=${choose(item.part)} aria-current=${item.part === part ? "page" : null}>${item.label}</a>`)}</nav>
    ${View ? html`<${View} />` : html`<${Notice} kind="warn"><p>This part needs a key with the scope admin.</p></${Notice}>`}`;
}
