// One site: what it is, where it stands in its work, targets to print.
import { address, get, patch, remove } from "../core/api.js";
import { time } from "../core/format.js";
import { useAction, useLoaded } from "../core/hooks.js";
import { html, useState } from "../core/html.js";
import { go } from "../core/router.js";
import { download } from "../core/save.js";
import { may } from "../core/session.js";
import { Button, Dialog, Facts, Failure, Field, Loaded } from "../ui/parts.js";

export default function Site({ site: siteId, who }) {
  const site = useLoaded(() => get(`/sites/${siteId}`), [siteId]);
  return html`<${Loaded} of=${site}>${(found) => html`<${Overview} site=${found} who=${who} onChange=${site.reload} />`}</${Loaded}>`;
}

function Overview({ site, who, onChange }) {
  const [open, setOpen] = useState(null);
  const surveyor = may(who, "survey");
  return html`<div class="row spread"><h1>${site.name}</h1>
      <div class="row">${surveyor && html`<${Button} onClick=${() => setOpen("rename")}>Rename</${Button}><${Button} kind="danger" onClick=${() => setOpen("delete")}>Delete</${Button}>`}</div></div>
    <div class="columns">
      <section class="card"><h2>This site</h2><${Facts} of=${[
        ["Target map", site.map_version ? `version ${site.map_version}` : "none yet: post targets, photograph them, build"],
        ["Codes", site.code_family], ["Module u", `${(1000 * site.plate_u_m).toFixed(1)} mm, plates of ${(13000 * site.plate_u_m).toFixed(0)} mm`],
        ["On the Earth", site.geo_anchor ? `${site.geo_anchor.latitude_deg}°, ${site.geo_anchor.longitude_deg}°` : "not tied"],
        ["Made", time(site.created_at)], ["Id", html`<code>${site.site_id}</code>`]]} /></section>
      <${Sheets} site=${site} />
    </div>
    ${open === "rename" && html`<${Rename} site=${site} onDone=${() => { setOpen(null); onChange(); }} onClose=${() => setOpen(null)} />`}
    ${open === "delete" && html`<${Delete} site=${site} onClose=${() => setOpen(null)} />`}`;
}

const SIZES = ["A5", "A4", "A3", "A2", "A1", "A0", "letter"];

/** Targets to print: the service chooses codes that hang nowhere yet, and reads every page back. */
function Sheets({ site }) {
  const [form, setForm] = useState({ which: "count", count: 20, codes: "", size: "A4" });
  const change = (name) => (event) => setForm((before) => ({ ...before, [name]: event.target.value }));
  const printing = useAction(async () => {
    const wanted = form.which === "count" ? { count: form.count } : { codes: form.codes.replace(/\s+/g, "") };
    await download(address("/targets/sheets.pdf", { ...wanted, size: form.size, site_id: site.site_id }), `targets-${site.name}.pdf`);
  });
  return html`<section class="card"><h2>Print targets</h2>
    <form class="stack" onSubmit=${(event) => { event.preventDefault(); printing.run(); }}>
      <${Failure} error=${printing.error} />
      <${Field} label="Which"><select value=${form.which} onChange=${change("which")}><option value="count">New codes, far apart from each other</option><option value="codes">These codes</option></select></${Field}>
      ${form.which === "count" ? html`<${Field} label="How many"><input type="number" min="1" max="1000" required value=${form.count} onInput=${change("count")} /></${Field}>`
        : html`<${Field} label="Codes" hint="Numbers and ranges: 389, 400-420"><input required value=${form.codes} onInput=${change("codes")} /></${Field}>`}
      <${Field} label="Paper"><select value=${form.size} onChange=${change("size")}>${SIZES.map((size) => html`<option>${size}</option>`)}</select></${Field}>
      <p class="small muted">Print at 100 %, then measure the two check bars of a sheet: each is 100 mm long.</p>
      <div><${Button} type="submit" kind="primary" busy=${printing.busy}>Make the sheets</${Button}></div>
    </form></section>`;
}

function Rename({ site, onDone, onClose }) {
  const [name, setName] = useState(site.name);
  const renaming = useAction(async () => { await patch(`/sites/${site.site_id}`, { name }); onDone(); });
  return html`<${Dialog} title="Rename the site" onClose=${onClose}><form class="stack" onSubmit=${(event) => { event.preventDefault(); renaming.run(); }}>
    <${Failure} error=${renaming.error} /><${Field} label="Name"><input required maxlength="200" value=${name} onInput=${(event) => setName(event.target.value)} /></${Field}>
    <div><${Button} type="submit" kind="primary" busy=${renaming.busy}>Rename</${Button}></div></form></${Dialog}>`;
}

function Delete({ site, onClose }) {
  const [typed, setTyped] = useState("");
  const deleting = useAction(async () => { await remove(`/sites/${site.site_id}`); go("#/"); });
  return html`<${Dialog} title="Delete the site" onClose=${onClose}><div class="stack">
    <p>Its surveys, maps and trajectories go with it; nothing brings them back but a backup.</p><${Failure} error=${deleting.error} />
    <${Field} label=${`Type "${site.name}" to be sure`}><input value=${typed} onInput=${(event) => setTyped(event.target.value)} /></${Field}>
    <div><${Button} kind="danger" disabled=${typed !== site.name} busy=${deleting.busy} onClick=${deleting.run}>Delete for good</${Button}></div></div></${Dialog}>`;
}
