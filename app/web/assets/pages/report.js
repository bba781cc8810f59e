// The adjustment of a map version, worst first: what to look at before signing, and how to do it again without.
import { all, get, post } from "../core/api.js";
import { plural, time } from "../core/format.js";
import { useAction, useLoaded } from "../core/hooks.js";
import { html, useEffect, useState } from "../core/html.js";
import { amend } from "../core/router.js";
import { may } from "../core/session.js";
import { Badge, Button, Empty, Failure, Field, Loaded } from "../ui/parts.js";
import { Build } from "../survey/build.js";
import { Comparison } from "../survey/compare.js";
import { exclusionOf, setExclusion, sizeOf, useExclusion } from "../survey/exclusion.js";
import { Findings, Summary } from "../survey/report_summary.js";
import { Photos, Points, Targets } from "../survey/report_tables.js";

export default function ReportPage({ site: siteId, query, who }) {
  const loaded = useLoaded(async () => ({ site: await get(`/sites/${siteId}`), versions: await all(`/sites/${siteId}/maps`, "maps") }), [siteId, query.version]);
  return html`<${Loaded} of=${loaded}>${({ site, versions }) => (versions.length
    ? html`<${Versions} key=${query.version} site=${site} versions=${versions} first=${Number(query.version) || site.map_version || versions.at(-1).map_version} who=${who} onChange=${loaded.reload} />`
    : html`<h1>Report</h1><${Empty}>No target map yet. Open a <a href=${`#/sites/${siteId}/surveys`}>survey</a>, add photographs and build it.</${Empty}>`)}</${Loaded}>`;
}

function Versions({ site, versions, first, who, onChange }) {
  const [version, setVersion] = useState(first);
  const choose = (event) => { setVersion(Number(event.target.value)); amend({ version: event.target.value }); };
  const map = versions.find((candidate) => candidate.map_version === version);
  const activating = useAction(async () => { await post(`/sites/${site.site_id}/maps/${version}/activate`); onChange(); });
  const file = (format) => `/sites/${site.site_id}/report?format=${format}&version=${version}`;
  return html`<div class="row spread"><h1>Adjustment report</h1>
      <div class="row"><a class="button" href=${file("pdf")} target="_blank" rel="noopener">PDF</a><a class="button" href=${file("html")} target="_blank" rel="noopener">Full report</a><a class="button" href=${file("json")} download=${`report-v${version}.json`}>JSON</a></div></div>
    <div class="row report-version"><${Field} label="Version"><select value=${version} onChange=${choose}>${versions.map((item) => html`<option value=${item.map_version}>version ${item.map_version}: ${plural(item.targets, "target")}, ${time(item.created_at)}</option>`)}</select></${Field}>
      ${map?.active ? html`<${Badge} kind="good">in use</${Badge}>` : may(who, "survey") && html`<${Button} busy=${activating.busy} onClick=${activating.run}>Use this version</${Button}>`}
      ${map?.survey_id && may(who, "survey") && html`<a href=${`#/sites/${site.site_id}/surveys/${map.survey_id}`}>its survey</a>`}</div>
    <${Failure} error=${activating.error} />
    <${Report} key=${version} site=${site} version=${version} surveyId=${map?.survey_id} who=${who} />
    ${versions.length > 1 && html`<${Comparison} siteId=${site.site_id} versions=${versions} version=${version} />`}`;
}

function Report({ site, version, surveyId, who }) {
  const report = useLoaded((signal) => get(`/sites/${site.site_id}/report?format=json&version=${version}`, { signal }), [version]);
  return html`<${Loaded} of=${report}>${(found) => html`<${Summary} report=${found} /><${Findings} report=${found} />
    <${Body} site=${site} report=${found} surveyId=${may(who, "survey") ? surveyId : null} />`}</${Loaded}>`;
}

/** The tables; with what their rows' boxes leave out of the next build. */
function Body({ site, report, surveyId }) {
  const [exclusion, change] = useExclusion(surveyId ?? "");
  // Who starts from a report starts from what that build left out.
  useEffect(() => { if (surveyId && !sizeOf(exclusionOf(surveyId))) setExclusion(surveyId, report.excluded); }, [surveyId]);
  const use = surveyId ? (kind, item, label) => html`<input type="checkbox" aria-label=${`Use ${label} in the next build`} checked=${!exclusion[kind].includes(item)} onClick=${(event) => event.stopPropagation()} onChange=${() => change(kind, item)} />` : null;
  return html`<${Photos} site=${site} surveyId=${surveyId} report=${report} use=${use} /><${Targets} site=${site} report=${report} use=${use} /><${Points} report=${report} use=${use} />
    ${surveyId && html`<${Again} site=${site} surveyId=${surveyId} />`}`;
}

function Again({ site, surveyId }) {
  const loaded = useLoaded(async () => ({ photos: await all(`/surveys/${surveyId}/images`, "images"), points: (await get(`/sites/${site.site_id}/control-points`)).control_points }), [surveyId]);
  return html`<${Loaded} of=${loaded}>${({ photos, points }) => html`<div class="again"><p class="small muted">Take a photograph, target or point out by its box in the tables, then build again.</p>
    <${Build} site=${site} surveyId=${surveyId} names=${photos.map((photo) => photo.name)} points=${points} /></div>`}</${Loaded}>`;
}
