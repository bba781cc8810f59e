// The surveys of a site: list them, open one.
import { all, get, post } from "../core/api.js";
import { time } from "../core/format.js";
import { useAction, useLoaded } from "../core/hooks.js";
import { html, useState } from "../core/html.js";
import { go } from "../core/router.js";
import { may } from "../core/session.js";
import { Badge, Button, Dialog, Empty, Failure, Field, Loaded, Table } from "../ui/parts.js";

export default function Surveys({ site: siteId, who }) {
  const surveys = useLoaded(() => load(siteId), [siteId]);
  const [opening, setOpening] = useState(false);
  return html`<div class="row spread"><h1>Surveys</h1>${may(who, "survey") && html`<${Button} kind="primary" onClick=${() => setOpening(true)}>New survey</${Button}>`}</div>
    <p class="muted">A survey is one set of photographs. Building it makes a new version of the site's target map; versions stay, and any of them can be used.</p>
    <${Loaded} of=${surveys}>${(found) => (found.length ? html`<${SurveyTable} siteId=${siteId} surveys=${found} />` : html`<${Empty}>No survey yet. Post targets, photograph them from several places, and open a survey for the photographs.</${Empty}>`)}</${Loaded}>
    ${opening && html`<${NewSurvey} siteId=${siteId} onClose=${() => setOpening(false)} />`}`;
}

/** Surveys with the map versions that were built of each. */
async function load(siteId) {
  const [surveys, maps] = await Promise.all([all(`/sites/${siteId}/surveys`, "surveys"), all(`/sites/${siteId}/maps`, "maps"), get(`/sites/${siteId}`)]);
  return surveys.map((survey) => ({ ...survey, versions: maps.filter((version) => version.survey_id === survey.survey_id) }));
}

const Version = ({ siteId, version }) => html`<a href=${`#/sites/${siteId}/report?version=${version.map_version}`}>version ${version.map_version}</a>${version.active && html` <${Badge} kind="good">in use</${Badge}>`} `;

function SurveyTable({ siteId, surveys }) {
  const columns = [
    { key: "note", label: "Survey", kind: "name", value: (survey) => survey.note, show: (survey) => html`<a href=${`#/sites/${siteId}/surveys/${survey.survey_id}`}>${survey.note || "without a note"}</a>` },
    { key: "made", label: "Opened", value: (survey) => survey.created_at, show: (survey) => time(survey.created_at) },
    { key: "maps", label: "Built", value: (survey) => survey.versions.length, show: (survey) => (survey.versions.length ? survey.versions.map((version) => html`<${Version} siteId=${siteId} version=${version} />`) : html`<span class="muted">not yet</span>`) },
  ];
  return html`<${Table} caption="Surveys" columns=${columns} rows=${surveys} keyOf=${(survey) => survey.survey_id} sortBy="made" descending=${true} />`;
}

function NewSurvey({ siteId, onClose }) {
  const [note, setNote] = useState("");
  const opening = useAction(async () => {
    const survey = await post(`/sites/${siteId}/surveys`, { note });
    go(`#/sites/${siteId}/surveys/${survey.survey_id}`);
  });
  return html`<${Dialog} title="New survey" onClose=${onClose}><form class="stack" onSubmit=${(event) => { event.preventDefault(); opening.run(); }}>
    <${Failure} error=${opening.error} />
    <${Field} label="Note" hint="What you will know it by: the day, the reason, who took the photographs."><input maxlength="1000" value=${note} onInput=${(event) => setNote(event.target.value)} placeholder="First survey, all walls" /></${Field}>
    <div><${Button} type="submit" kind="primary" busy=${opening.busy}>Open the survey</${Button}></div></form></${Dialog}>`;
}
