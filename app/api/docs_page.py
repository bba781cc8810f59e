"""``/docs``: the OpenAPI document as a page without a script and without a request to anybody.

The framework's own page loads its script from another host, which learns then who works with this service.
"""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Sequence
from hashlib import sha256
from html import escape
from itertools import groupby
from typing import Any

STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }
summary { cursor: pointer; padding: .3rem 0; }
summary code { font-weight: 600; }
details > div { border-left: 3px solid #8886; padding-left: 1rem; margin-bottom: 1rem; }
table { border-collapse: collapse; }
td, th { text-align: left; vertical-align: top; padding: .15rem 1rem .15rem 0; }
pre { overflow-x: auto; background: #8881; padding: .5rem; }
"""
STYLE_DIGEST = b64encode(sha256(STYLE.encode()).digest()).decode()
CONTENT_SECURITY_POLICY = "; ".join(
    (
        "default-src 'none'",
        f"style-src 'sha256-{STYLE_DIGEST}'",
        "base-uri 'none'",
        "form-action 'none'",
        "frame-ancestors 'none'",
    )
)
REFERENCE = "#/components/schemas/"

Call = tuple[str, str, dict[str, Any]]  # method, path, what the document says of it


def docs_page(document: dict[str, Any]) -> str:
    """The page of an OpenAPI document."""
    calls = [
        (method.upper(), path, call) for path, methods in document["paths"].items() for method, call in methods.items()
    ]
    groups = groupby(sorted(calls, key=_tag_of), key=_tag_of)
    sections = "".join(f"<h2>{escape(tag)}</h2>{''.join(map(_call_html, group))}" for tag, group in groups)
    schemas = "".join(_schema_html(name, schema) for name, schema in document["components"]["schemas"].items())
    title = escape(document["info"]["title"])
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>{title}: the calls</title>
<style>{STYLE}</style>
</head>
<body>
<h1>{title}</h1>
<p>{escape(document["info"].get("description", ""))} For machines: <a href="openapi.json">openapi.json</a>.</p>
{sections}
<h2>what is sent and answered</h2>
{schemas}
</body>
</html>
"""


def _tag_of(call: Call) -> str:
    return str(next(iter(call[2].get("tags", [])), "other"))


def _call_html(described: Call) -> str:
    method, path, call = described
    scopes = sorted({scope for entry in call.get("security", []) for names in entry.values() for scope in names})
    parameters = [
        (item["name"], item["in"], "required" if item.get("required") else "", item.get("description", ""))
        for item in call.get("parameters", [])
    ]
    parts = [
        f"<p>{escape(call.get('description', ''))}</p>",
        f"<p>Key with the scope {escape(' or '.join(scopes))}.</p>" if scopes else "<p>Takes everybody.</p>",
        _table_html("Parameters", parameters),
        _table_html(
            "Body", [(kind, _schema_link(content)) for kind, content in _contents(call.get("requestBody", {}))]
        ),
        _table_html("Answers", [_answer_row(status, answer) for status, answer in call["responses"].items()]),
    ]
    head = f"<summary><code>{method} {escape(path)}</code> {escape(call.get('summary', ''))}</summary>"
    return f"<details>{head}<div>{''.join(parts)}</div></details>"


def _answer_row(status: str, answer: dict[str, Any]) -> tuple[str, ...]:
    kinds = _contents(answer)
    return status, answer.get("description", ""), ", ".join(f"{kind} {_schema_link(body)}" for kind, body in kinds)


def _contents(holder: dict[str, Any]) -> list[tuple[str, dict[str, Any]]]:
    return list(holder.get("content", {}).items())


def _schema_link(content: dict[str, Any]) -> str:
    """The name of a body's schema; the tables escape it and link it."""
    return str(content.get("schema", {}).get("$ref", ""))


def _table_html(title: str, rows: Sequence[tuple[str, ...]]) -> str:
    if not rows:
        return ""
    lines = "".join(f"<tr>{''.join(f'<td>{_cell_html(cell)}</td>' for cell in row)}</tr>" for row in rows)
    return f"<p>{title}</p><table>{lines}</table>"


def _cell_html(text: str) -> str:
    before, reference, name = text.partition(REFERENCE)
    return escape(before) + (f'<a href="#{escape(name)}">{escape(name)}</a>' if reference else "")


def _schema_html(name: str, schema: dict[str, Any]) -> str:
    text = escape(json.dumps(schema, indent=2, ensure_ascii=False))
    return f'<details id="{escape(name)}"><summary><code>{escape(name)}</code></summary><pre>{text}</pre></details>'
