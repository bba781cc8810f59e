// One survey, in the order of its work: photographs, control points, what is lacking, build.
import { all, get } from "../core/api.js";
import { time } from "../core/format.js";
import { useLoaded } from "../core/hooks.js";
import { html, useCallback, useState } from "../core/html.js";
import { Loaded } from "../ui/parts.js";
import { Build } from "../survey/build.js";
import { ControlPoints } from "../survey/control_points.js";
import { Guidance } from "../survey/guidance.js";
import { Photographs } from "../survey/photographs.js";

export default function SurveyPage({ site: siteId, survey: surveyId }) {
  const loaded = useLoaded((signal) => load(siteId, surveyId, signal), [siteId, surveyId]);
  return html`<${Loaded} of=${loaded}>${({ site, survey }) => html`<${Work} site=${site} survey=${survey} />`}</${Loaded}>`;
}

async function load(siteId, surveyId, signal) {
  const [site, survey] = await Promise.all([get(`/sites/${siteId}`, { signal }), get(`/surveys/${surveyId}`, { signal })]);
  return { site, survey };
}

function Work({ site, survey }) {
  const photos = useLoaded(() => all(`/surveys/${survey.survey_id}/images`, "images"), [survey.survey_id]);
  const [points, setPoints] = useState(null); // what is stored of control points, once that is known
  const [guidance, setGuidance] = useState(null);
  const onPoints = useCallback(setPoints, []);
  const names = (photos.data ?? []).map((photo) => photo.name);
  return html`<p class="crumbs"><a href=${`#/sites/${site.site_id}/surveys`}>Surveys of ${site.name}</a></p>
    <h1>${survey.note || "Survey"}</h1>
    <p class="muted small">Opened ${time(survey.created_at)}</p>
    <div class="survey-work">
      <div class="stack survey-main">
        <${Photographs} site=${site} surveyId=${survey.survey_id} photos=${photos} guidance=${guidance} />
        <${ControlPoints} site=${site} onStored=${onPoints} />
        <${Build} site=${site} surveyId=${survey.survey_id} names=${names} points=${points ?? []} />
      </div>
      <${Guidance} site=${site} surveyId=${survey.survey_id} version=${`${names.length} ${JSON.stringify(points)}`} onFound=${setGuidance} />
    </div>`;
}
