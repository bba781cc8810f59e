"""Names that attack their readers."""

from __future__ import annotations

HOSTILE = (
    "<script>alert(1)</script>",
    '"><img src=x onerror=alert(1)>',
    "</style></svg></title><b>bold</b>",
    '<font color="[[[1]]]" name="Nothing">font</font>',
    '<img src="file:///etc/passwd" width="9"/>',
    '<a href="javascript:alert(1)">link</a>',
    "&lt;i&gt; &#60;u&#62; &amp; ]]> <!-- <![CDATA[",
    "#import *strong* $x^2$ @cite {{7*7}} %s {0} \\input{x} (((",
    "turned \u202e gpj.exe",
    "bell \x07 null \x00 lines \r\n and\ttabs",
    "Łódź Ωmega 会议室 かな 회의 🙂 ﷽",
    "long-" * 60,
)
