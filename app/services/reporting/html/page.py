"""A document as one HTML file: no script, no request to anybody, its style inside and allowed by digest."""

from __future__ import annotations

from base64 import b64encode
from hashlib import sha256
from importlib.resources import files

from app.services.reporting.document import Document
from app.services.reporting.html.blocks import section_html, shown

STYLE = files(__package__).joinpath("style.css").read_text(encoding="utf-8")
STYLE_DIGEST = b64encode(sha256(STYLE.encode()).digest()).decode()

# The file carries its policy with it: whatever a name may hold, nothing runs and nothing is fetched.
CONTENT_SECURITY_POLICY = f"default-src 'none'; style-src 'sha256-{STYLE_DIGEST}'; base-uri 'none'; form-action 'none'"


def html_of(document: Document) -> str:
    """The document as a complete HTML page."""
    sections = [(f"part-{number}", section) for number, section in enumerate(document.sections, start=1)]
    links = "".join(f'<li><a href="#{anchor}">{shown(section.title)}</a></li>' for anchor, section in sections)
    body = "".join(section_html(section, anchor) for anchor, section in sections)
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{CONTENT_SECURITY_POLICY}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<meta name="referrer" content="no-referrer">
<meta name="generator" content="{shown(document.producer)}">
<title>{shown(document.title)}: {shown(document.running_title)}</title>
<style>{STYLE}</style>
</head>
<body>
<header><p>{shown(document.title)}</p><h1>{shown(document.subject)}</h1></header>
<nav aria-label="Contents"><ol>{links}</ol></nav>
<main>
{body}</main>
<footer><p>{shown(document.running_title)} · {shown(document.producer)}</p></footer>
</body>
</html>
"""
