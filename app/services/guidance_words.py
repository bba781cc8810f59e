"""Guidance for people: what each target lacks and from where to photograph it, in sentences."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.photogrammetry.survey_guidance import Frame, Guidance, GuidedTarget
from app.photogrammetry.viewpoints import Shot

LEAST_STEP_M = 0.1  # less is not worth saying: nobody holds a phone more exactly
STEP_DIGITS = 1


def advice_for(target: GuidedTarget, guidance: Guidance) -> str:
    """What to do about a target; empty when it has all that it needs."""
    if target.state == "good":
        return ""
    return f"target {target.code}: {_lack(target, guidance)}; {_remedy(target, guidance.frame)}"


def summary_of(guidance: Guidance) -> str:
    """How the survey stands, in one or two sentences."""
    good = len(guidance.targets) - len(guidance.lacking)
    taken = f"{guidance.photographs} photograph{'' if guidance.photographs == 1 else 's'}"
    text = f"{good} of {len(guidance.targets)} targets have what they need, after {taken}."
    if not guidance.targets:
        text = f"No target was seen yet in {taken}." if guidance.photographs else "No photograph was looked at yet."
    if guidance.loose:
        text += f" {_listed(guidance.loose)} share too few targets with the others: photograph what lies between."
    return f"{text} {guidance.trouble}".strip()


def place_in_words(shot: Shot, frame: Frame) -> str:
    """Where to stand: coordinates of the site, or steps from a photograph that was taken."""
    steps = [
        f"{abs(step_m):.{STEP_DIGITS}f} m {words[step_m < 0]}"
        for step_m, words in (
            (shot.right_m, ("to the right", "to the left")),
            (shot.back_m, ("farther back", "nearer")),
            (shot.up_m, ("higher", "lower")),
        )
        if abs(step_m) >= LEAST_STEP_M
    ]
    relative = (
        f"{', '.join(steps) or 'where'}{' from where' if steps else ''} {shot.beside} was taken, facing the target"
    )
    if frame != "site":
        return relative
    x_m, y_m, _ = shot.eye_m
    return f"from about ({x_m:.1f}, {y_m:.1f}) m, looking {heading_deg(shot):.0f} degrees from the x axis ({relative})"


def heading_deg(shot: Shot) -> float:
    """Direction of the view in the floor plan, from the site's x axis counter-clockwise."""
    x_m, y_m = (shot.aim_m - shot.eye_m)[:2]
    return float(np.degrees(np.arctan2(y_m, x_m)) % 360.0)


def _lack(target: GuidedTarget, guidance: Guidance) -> str:
    if target.state == "unseen":
        return "carries a control point and is in no photograph"
    if target.state == "few-rays":
        return f"{target.rays} ray{'' if target.rays == 1 else 's'}, needs {guidance.fewest_rays}"
    if target.state == "apart":
        return f"seen in {target.rays} photographs that do not hang together with the others"
    assert target.angle_rad is not None, "rays that meet too narrowly have an angle"
    needed_deg = np.degrees(guidance.least_angle_rad)
    return f"its rays meet at {np.degrees(target.angle_rad):.1f} degrees, needs {needed_deg:.0f}"


def _remedy(target: GuidedTarget, frame: Frame) -> str:
    together = f" together with {_listed(target.companions)}" if target.companions else ""
    if target.shot is None:
        return f"take another photograph showing it{together}, from another place"
    return f"take another photograph showing it{together}: {place_in_words(target.shot, frame)}"


def _listed(items: Sequence[object]) -> str:
    *first, last = (str(item) for item in items)
    return f"{', '.join(first)} and {last}" if first else last
