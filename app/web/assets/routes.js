// Which address shows which page; a page's code comes when it is first wanted.
export const routes = [
  { path: "/", load: () => import("./pages/sites.js"), title: "Sites", top: "sites" },
  { path: "/sites/:site", load: () => import("./pages/site.js"), title: "Site", top: "sites", tab: "" },
  { path: "/sites/:site/surveys", load: () => import("./pages/surveys.js"), title: "Surveys", top: "sites", tab: "surveys" },
  { path: "/sites/:site/surveys/:survey", load: () => import("./pages/survey.js"), title: "Survey", top: "sites", tab: "surveys" },
  { path: "/sites/:site/surveys/:survey/photos/:photo", load: () => import("./pages/photo.js"), title: "Photograph", top: "sites", tab: "surveys", wide: true },
  { path: "/sites/:site/report", load: () => import("./pages/report.js"), title: "Report", top: "sites", tab: "report" },
  { path: "/sites/:site/room", load: () => import("./pages/room.js"), title: "Room", top: "sites", tab: "room", wide: true },
  { path: "/sites/:site/phone/calibration", load: () => import("./pages/calibration.js"), title: "Calibrate a camera", top: "sites", tab: "phone" },
  { path: "/sites/:site/phone", load: () => import("./pages/phone.js"), title: "Phone", top: "sites", tab: "phone" },
  { path: "/sites/:site/trajectories", load: () => import("./pages/trajectories.js"), title: "Trajectories", top: "sites", tab: "trajectories" },
  { path: "/trajectories/:trajectory", load: () => import("./pages/trajectory.js"), title: "Trajectory", top: "sites" },
  { path: "/sites/:site/evaluations", load: () => import("./pages/evaluations.js"), title: "Evaluations", top: "sites", tab: "evaluations" },
  { path: "/evaluations/live/:live", load: () => import("./pages/live_evaluation.js"), title: "Live evaluation", top: "sites" },
  { path: "/evaluations/:evaluation", load: () => import("./pages/evaluation.js"), title: "Evaluation", top: "sites" },
  { path: "/sites/:site/alerts", load: () => import("./pages/alerts.js"), title: "Alerts", top: "sites", tab: "alerts" },
  { path: "/operator", load: () => import("./pages/operator.js"), title: "Operator", top: "operator" },
];

/** The tabs of a site, in the order of its work. */
export const siteTabs = [
  { tab: "", label: "Overview" },
  { tab: "surveys", label: "Surveys", scopes: ["survey"] },
  { tab: "report", label: "Report", scopes: ["survey", "analyse"] },
  { tab: "room", label: "Room" },
  { tab: "phone", label: "Phone", scopes: ["locate"] },
  { tab: "trajectories", label: "Trajectories", scopes: ["analyse"] },
  { tab: "evaluations", label: "Evaluations", scopes: ["analyse"] },
  { tab: "alerts", label: "Alerts", scopes: ["survey", "analyse"] },
];
