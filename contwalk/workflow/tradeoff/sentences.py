"""What a tradeoff comes to, in sentences: the setting to take, and what giving up digits buys."""

from __future__ import annotations

import math

from contwalk.workflow.tradeoff.trials import Setting, Tradeoff, Trial


def recommendation(found: Tradeoff) -> str:
    """What to set."""
    kind, ties = found.kind, found.ties
    if not ties:
        return f"No setting met the accuracy of {found.wanted:g} that is asked for."
    best = ties[0]
    asked = best.setting.accuracy
    met = f"met the accuracy of {found.wanted:g}"
    text = (
        f"The cheapest setting that {met} is {kind.written(best.setting)}: {seconds(best)}, and all "
        f"{kind.results} to {max(best.worst, found.doubt):.1e} at least."
    )
    if len(ties) > 1:
        others = "; ".join(_short(found, trial.setting) for trial in ties[1:])
        text = (
            f"Tie: the times of {len(ties)} settings that {met} are within their scatter. The most accurate "
            f"of them is {kind.written(best.setting)}: {seconds(best)}, and all {kind.results} to "
            f"{max(best.worst, found.doubt):.1e} at least. The others: {others}."
        )
    kept = next((t for t in found.trials if t.setting == _promised(found, best)), None)
    if kind.promises and asked > found.wanted and kept is not None and found.held(kept):
        text += (
            f" It promises {asked:g} only; accuracy: {found.wanted:g} keeps its promise for {seconds(kept)}."
        )
    return text


def _promised(found: Tradeoff, best: Trial) -> Setting:
    return Setting(found.wanted, best.setting.method, best.setting.model)


def _short(found: Tradeoff, setting: Setting) -> str:
    model = f"{setting.model or 'as it is'}"
    return model if found.kind.form.startswith("model") else f"{setting.accuracy:g} with {setting.method}"


def seconds(trial: Trial) -> str:
    """The least time with its scatter, as `0.47 s (5 runs: to 0.53 s)`."""
    if not trial.spread > 0.0:
        return f"{trial.seconds:.2g} s"
    return f"{trial.seconds:.2g} s ({len(trial.times)} runs: to {trial.seconds + trial.spread:.2g} s)"


def digits(found: Tradeoff) -> str:
    """What giving up digits buys with each method; empty where no two accuracies found everything."""
    spans: dict[str, list[str]] = {}
    for method in dict.fromkeys(trial.setting.method for trial in found.trials):
        tried = [t for t in found.trials if t.setting.method == method and t.meets(math.inf)]
        if len({t.setting.accuracy for t in tried}) < 2:
            continue
        few = max(tried, key=lambda t: t.setting.accuracy)
        many = min(tried, key=lambda t: t.setting.accuracy)
        number = math.log10(few.setting.accuracy / many.setting.accuracy)
        span = f"Giving up {number:.2g} digits, from {many.setting.accuracy:g} to {few.setting.accuracy:g}"
        spans.setdefault(span, []).append(f"{_buys(many, few)} with {method}")
    return " ".join(f"{span}, {'; '.join(each)}." for span, each in spans.items())


def _buys(many: Trial, few: Trial) -> str:
    """What the time of many digits is beside that of few."""
    if many.ties(few):
        return f"buys nothing (a tie, {many.seconds:.2g} s and {few.seconds:.2g} s)"
    if many.seconds < few.seconds:
        return f"costs time ({many.seconds:.2g} s and {few.seconds:.2g} s)"
    return f"makes it {many.seconds / few.seconds:.3g} times as fast"
