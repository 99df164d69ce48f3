"""The part of the report on one demonstration: its signals, its path, and why each requirement holds or fails.

In: a demonstration's scores. Out: a part that can be folded. What decides is explained here, so that of very many
demonstrations only those that are shown cost anything.
"""

from dataclasses import replace

from stlspec.compiler.bundle import BundleData
from stlspec.compiler.printing import counted
from stlspec.markup.elements import Markup, element, join, number, short
from stlspec.markup.grids import Board, board_svg
from stlspec.markup.tables import verdict_text
from stlspec.pictures.contents import picture_of
from stlspec.pictures.panels import panels
from stlspec.scores import DemonstrationScore, RequirementScore
from stlspec.semantics.explain import Explanation, explain

MOST_EXPLAINED = 40
"""Of more requirements those that fail are explained first, and the rest is counted."""

_MOST_STEPS = 12


def demonstration_section(
    bundle: BundleData, score: DemonstrationScore, index: int, path: Board | None, *, unfolded: bool
) -> Markup:
    """Write the part on one demonstration.

    Not in the paper: it explains a ranking.

    Args: index: its number, for links. path: its way on the map. unfolded: whether it can be read at once.
    """
    whole = score
    score = replace(score, requirements=_chosen(score))
    explanations = {name: explain(bundle, name, found.evaluated) for name, found in score.requirements.items()}
    label = score.label or ("undecided" if score.reward is None and score.rank is None else "")
    head = [element("span", short(score.name), class_="name"), " "]
    if label:
        head += [element("span", label, class_=f"label {label}"), " "]
    if score.reward is not None:
        head.append(element("span", f"rank {score.rank}, reward {number(score.reward)}", class_="muted"))
    way = [_map(path)] if path is not None else []
    charts = panels(picture_of(bundle, score, explanations))
    reasons = [_reason(found) for found in explanations.values()]
    left = len(whole.requirements) - len(explanations)
    if left:
        reasons.append(
            element("p", f"{counted(left, 'requirement')} more; the table has their values.", class_="muted")
        )
    return element(
        "details",
        element("summary", *head),
        element("h3", "Signals and robustness over time"),
        element("div", *way, element("div", *charts, class_="panels"), class_="demo" if way else None),
        *reasons,
        id=f"d{index}",
        open=unfolded,
    )


def _chosen(score: DemonstrationScore) -> dict[str, RequirementScore]:
    """Return the requirements to explain, in their order: all, or those that fail and the first ones."""
    names = sorted(score.requirements, key=lambda name: score.requirements[name].result.verdict.value != "violated")
    kept = set(names[:MOST_EXPLAINED])
    return {name: found for name, found in score.requirements.items() if name in kept}


def _map(path: Board) -> Markup:
    picture = board_svg(path, "Its path on the map", 360)
    words = f"Its path, {len(path.path)} states; the disc is where it ends."
    return element("figure", picture, element("figcaption", words), class_="map")


def _reason(found: Explanation) -> Markup:
    heading = element(
        "h3",
        f"{short(found.requirement)} ({found.strength}) ",
        verdict_text(found.verdict.value, number(found.robustness)),
    )
    parts = [(name, words) for name, words in found.parts() if words and name != "by way of"]
    pairs = join(join([element("dt", name), element("dd", words)]) for name, words in parts)
    return join([heading, element("dl", pairs, class_="why") if parts else "", _way(found)])


def _way(found: Explanation) -> Markup:
    """List the sub-formulas from the requirement down to what decides."""
    steps = found.steps
    if len(steps) < 2:
        return join([])
    shown = [*steps[: _MOST_STEPS - 1], steps[-1]] if len(steps) > _MOST_STEPS else list(steps)
    items = []
    for step in shown:
        name = f"{step.name}: " if step.name else ""
        when = "" if found.unit == "step" else f" ({number(step.time)} {found.unit})"
        said = f" at sample {step.sample}{when}: robustness {number(step.robustness)}"
        items.append(element("li", name, element("code", step.text), element("span", said, class_="muted")))
    return element("ol", *items, class_="way", aria_label=f"From {short(found.requirement)} to what decides it")
