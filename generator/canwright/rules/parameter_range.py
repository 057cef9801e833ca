"""The limits of a parameter allow a value, and its choices are distinct.

So are reply times and default bit rates: they are above 0, and one of the bit rates.
"""

from __future__ import annotations

from fractions import Fraction

from ..diagnostics.diagnostic import DocumentPath
from ..model import formatting
from .rule import CheckInput, Finding, Findings


def check(subject: CheckInput) -> Findings:
    for parameter in subject.edition.parameters:
        low, high = parameter.minimum, parameter.maximum
        if low is not None and high is not None and low > high:
            text = f"no number is at least {formatting.exact(low)} and at most {formatting.exact(high)}"
            yield Finding(("parameters", parameter.name, "number", "min"), text, "check `min` and `max`")
        if high is not None and high <= 0 and subject.edition.is_factor(parameter):
            text = f"a scale is a multiple of `{parameter.name}`, so it must be above 0, but `max` is {formatting.exact(high)}"
            yield Finding(("parameters", parameter.name, "number", "max"), text, "check `max`")
        names = [value.name for value in parameter.values]
        for i, name in enumerate(names):
            if name in names[:i]:
                yield Finding(("parameters", parameter.name, "values", i), f"duplicate value {name}", "remove one")
    times: dict[DocumentPath, Fraction | None] = {("bus",): subject.edition.bus.reply_within_ms}
    times |= {command.path: command.reply_within_ms for command in subject.edition.commands}
    for path, within in times.items():
        if within is not None and within <= 0:
            text = "write a number above 0, or remove it"
            yield Finding((*path, "reply_within_ms"), "the time must be above 0", text)
    for mode in subject.edition.bus.modes:
        if mode.default_kbps is not None and mode.default_kbps not in mode.bit_rates_kbps:
            text = f"{mode.default_kbps} kbit/s is not a bit rate of `{mode.name}`"
            yield Finding(("bus", "modes", mode.name, "default_kbps"), text, "add it to `bit_rates_kbps`")
