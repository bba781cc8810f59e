// Where a key is shown once; the browser keeps a cookie instead of it.
import { useAction } from "../core/hooks.js";
import { html, useState } from "../core/html.js";
import { showKey } from "../core/session.js";
import { Button, Dialog, Failure, Field } from "./parts.js";

const TITLE = "Key needed";
const HOW = "Paste the key that its operator gave you; this browser stays signed in for some hours and does not keep the key.";

/** For whoever comes without a key. */
export const SignIn = ({ onOpened }) => html`<section class="card sign-in"><h1>${TITLE}</h1><p>This service asks who you are. ${HOW}</p><${KeyForm} onOpened=${onOpened} /></section>`;

/** For whose key ran out in the midst of work, which waits behind it. */
export const SignInAgain = ({ onOpened, onClose }) => html`<${Dialog} title=${TITLE} onClose=${onClose}>
  <p>You were signed in for too long, or your key is valid no more. What you were doing waits. ${HOW}</p><${KeyForm} onOpened=${onOpened} /></${Dialog}>`;

function KeyForm({ onOpened }) {
  const [key, setKey] = useState("");
  const opening = useAction(async () => { await showKey(key.trim()); onOpened(); });
  return html`<form class="stack" onSubmit=${(event) => { event.preventDefault(); opening.run(); }}>
    <${Failure} error=${opening.error} />
    <${Field} label="Key"><input type="password" autocomplete="off" required value=${key} onInput=${(event) => setKey(event.target.value)} /></${Field}>
    <div><${Button} type="submit" kind="primary" busy=${opening.busy}>Sign in</${Button}></div>
  </form>`;
}
