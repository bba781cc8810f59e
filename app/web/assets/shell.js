// The frame around every page: where one is, who one is, what went wrong.
import { html, useEffect, useRef, useState } from "./core/html.js";
import { KEY_NEEDED, Unreachable } from "./core/api.js";
import { match } from "./core/router.js";
import { leave, may, whoAmI } from "./core/session.js";
import { routes, siteTabs } from "./routes.js";
import { Busy, Button, Empty, Failure, Notice } from "./ui/parts.js";
import { SignIn, SignInAgain } from "./ui/key_form.js";

const TOPS = [
  { top: "sites", href: "#/", label: "Sites" },
  { top: "operator", href: "#/operator", label: "Operator", scopes: ["survey", "analyse"] },
];

/** Who asks: undefined before that is known, null when nobody is signed in; `keyNeeded` when a key ran out in the midst of work. */
function useWho(onError) {
  const [who, setWho] = useState(undefined);
  const [keyNeeded, setKeyNeeded] = useState(false);
  const ask = () => whoAmI().then((found) => { setWho(found); setKeyNeeded(false); }, onError);
  useEffect(() => {
    const onKeyNeeded = () => setKeyNeeded(true);
    addEventListener(KEY_NEEDED, onKeyNeeded);
    ask();
    return () => removeEventListener(KEY_NEEDED, onKeyNeeded);
  }, []);
  return { who, keyNeeded, ask, putOff: () => setKeyNeeded(false) };
}

export function Shell({ linkError }) {
  const [hash, setHash] = useState(location.hash);
  const [error, setError] = useState(linkError);
  const { who, keyNeeded, ask, putOff } = useWho(setError);
  useEffect(() => {
    const onHash = () => setHash(location.hash);
    addEventListener("hashchange", onHash);
    return () => removeEventListener("hashchange", onHash);
  }, []);
  const found = match(hash, routes);
  const again = () => { setError(null); return ask(); };
  return html`<div class="shell">
    <${Top} hash=${hash} found=${found} who=${who} onLeave=${() => leave().then(ask, setError)} />
    <main id="content" tabindex="-1" class=${found?.route.wide ? "wide" : ""}>
      <${Failure} error=${error} retry=${who === undefined ? again : null} />
      ${who === null ? html`<${SignIn} onOpened=${again} />` : who === undefined ? !error && html`<p><${Busy} /> loading</p>` : html`<${Page} key=${who.scopes.join(" ")} found=${found} who=${who} />`}
      ${who && keyNeeded && html`<${SignInAgain} onOpened=${again} onClose=${putOff} />`}
    </main>
  </div>`;
}

function Top({ hash, found, who, onLeave }) {
  const shown = TOPS.filter((item) => !item.scopes || (who && may(who, ...item.scopes)));
  return html`<header class="top">
    <a class="skip" href=${hash || "#/"} onClick=${(event) => { event.preventDefault(); document.getElementById("content").focus(); }}>Skip to the content</a>
    <a class="brand" href="#/" aria-label="Scattermark"><img src="/assets/icon.svg" alt="" /><span>Scattermark</span></a>
    <nav aria-label="Main">${shown.map((item) => html`<a href=${item.href} aria-current=${found?.route.top === item.top ? "page" : null}>${item.label}</a>`)}</nav>
    <div class="end"><a class="small" href="/docs">Calls</a><${Theme} />${who?.key_id && html`<span class="small muted">${who.name}</span><${Button} kind="plain" onClick=${onLeave}>Sign out</${Button}>`}</div>
  </header>`;
}

/** Light, dark, or as the device has it. */
function Theme() {
  const next = { "": "dark", dark: "light", light: "" };
  const label = { "": "Auto", dark: "Dark", light: "Light" };
  const [theme, setTheme] = useState(localStorage.getItem("theme") || "");
  useEffect(() => {
    theme ? document.documentElement.setAttribute("data-theme", theme) : document.documentElement.removeAttribute("data-theme");
    localStorage.setItem("theme", theme);
  }, [theme]);
  return html`<${Button} kind="plain" aria-label=${`Colours: ${label[theme]}`} onClick=${() => setTheme(next[theme])}>◐ ${label[theme]}</${Button}>`;
}

function Page({ found, who }) {
  const [loaded, setLoaded] = useState(null);
  const [error, setError] = useState(null);
  useFocusOn(JSON.stringify([found?.route.path, found?.params]));
  useEffect(() => {
    if (!found) return;
    document.title = `${found.route.title} – Scattermark`;
    setError(null);
    found.route.load().then((module) => setLoaded({ route: found.route, view: module.default }), (cause) => setError(cause instanceof TypeError ? new Unreachable(cause) : cause)); // a module that does not come is a TypeError
  }, [found?.route]);
  if (!found) return html`<h1>Not found</h1><${Empty}>There is no such page. <a href="#/">All sites</a></${Empty}>`;
  if (error) return html`<${Failure} error=${error} retry=${() => location.reload()} />`; // browsers may remember a module that failed
  if (loaded?.route !== found.route) return html`<p><${Busy} /> loading</p>`;
  return html`${found.params.site && html`<${SiteTabs} site=${found.params.site} tab=${found.route.tab} who=${who} />`}
    <${loaded.view} key=${JSON.stringify(found.params)} ...${found.params} query=${found.query} who=${who} />`;
}

/** Whoever goes to another page by keys goes on from its beginning: the link that was followed is gone, and with it the focus. */
function useFocusOn(page) {
  const before = useRef(page);
  useEffect(() => {
    if (before.current !== page) document.getElementById("content").focus({ preventScroll: true });
    before.current = page;
  }, [page]);
}

function SiteTabs({ site, tab, who }) {
  const shown = siteTabs.filter((item) => !item.scopes || may(who, ...item.scopes));
  const row = useRef(null);
  useEffect(() => row.current.querySelector("[aria-current]")?.scrollIntoView({ block: "nearest", inline: "center" }), [tab]); // the row slides on phones
  return html`<nav class="tabs" aria-label="Site" ref=${row}>${shown.map((item) => html`<a href=${`#/sites/${site}${item.tab && `/${item.tab}`}`} aria-current=${item.tab === tab ? "page" : null}>${item.label}</a>`)}</nav>`;
}
