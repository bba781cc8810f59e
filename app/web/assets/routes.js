// Which address shows which page; a page's code comes when it is first wanted.
export const routes = [
  { path: "/", load: () => import("./pages/sites.js"), title: "Sites", top: "sites" },
  { path: "/sites/:site", load: () => import("./pages/site.js"), title: "Site", top: "sites", tab: "" },
  { path: "/operator", load: () => import("./pages/operator.js"), title: "Operator", top: "operator" },
];

/** The tabs of a site, in the order of its work. */
export const siteTabs = [
  { tab: "", label: "Overview" },
];
