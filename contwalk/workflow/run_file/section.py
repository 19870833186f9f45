"""A section of a run file: a mapping of known keys, each of a form."""

from __future__ import annotations

from typing import Any, ClassVar, NamedTuple, Self

from contwalk.workflow.run_file.faults import Fault, Invalid
from contwalk.workflow.run_file.forms import Form, as_mapping

_NEEDED = object()


class KeyOf(NamedTuple):
    """A key that a section knows; see `key`. `written` is how it is written in the file."""

    form: Form
    description: str
    default: Any
    written: str
    inside: type[Section] | None

    @property
    def needed(self) -> bool:
        """Whether it must be given."""
        return self.default is _NEEDED


def key(
    form: Form | type[Section],
    description: str,
    default: Any = _NEEDED,
    written: str = "",
    inside: type[Section] | None = None,
) -> Any:
    """A key of a section.

    Parameters
    ----------
    form : callable or Section
        What gives the value as it is used, and raises `Invalid` where it is none.
    description : str
        What is allowed, as messages say it.
    default
        The value where the key is not given; without one it must be.
    written : str, optional
        The key in the file, where the attribute cannot have its name.
    inside : Section, optional
        The section in the value, where it is part of a list or a mapping.
    """
    if isinstance(form, type) and issubclass(form, Section):
        return KeyOf(form.read, description, default, written, form)
    return KeyOf(form, description, default, written, inside)


class Section:
    """A mapping of known keys; a key with nothing after it counts as not given.

    What class attributes are made by `key` is a key of the section; its instances have the values. An
    instance that is made without data has all defaults.
    """

    keys: ClassVar[dict[str, KeyOf]] = {}

    def __init_subclass__(cls) -> None:
        found = {name: value for name, value in vars(cls).items() if isinstance(value, KeyOf)}
        cls.keys = {name: each._replace(written=each.written or name) for name, each in found.items()}

    def __init__(self) -> None:
        self.__dict__.update(type(self)._values({}))

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"a section that has been read stays as it is: {name}")

    @classmethod
    def read(cls, data: Any) -> Self:
        """The section that data describe.

        Raises
        ------
        Invalid
            With all that is wrong; where each key is right, with what does not fit together.
        """
        found = cls.__new__(cls)
        found.__dict__.update(cls._values(as_mapping(data)))
        found.fit()
        return found

    def fit(self) -> None:
        """Raise `Invalid` where values that are right one by one do not fit together."""

    @classmethod
    def _values(cls, data: dict[str, Any]) -> dict[str, Any]:
        """The value of each key by the name of its attribute."""
        values: dict[str, Any] = {}
        faults: list[Fault] = []
        for name, known in cls.keys.items():
            given = data.get(known.written)
            if given is None and known.needed:
                faults.append(Fault("the key is missing.").under(known.written, known.description))
            elif given is None:
                values[name] = dict(known.default) if isinstance(known.default, dict) else known.default
            else:
                try:
                    values[name] = known.form(given)
                except Invalid as error:
                    faults += [fault.under(known.written, known.description) for fault in error.faults]
        unknown = set(data).difference(cls.known_keys())
        faults += [Fault("unknown key.", at=(name,), unknown_in=cls) for name in data if name in unknown]
        if faults:
            raise Invalid(faults)
        return values

    @classmethod
    def known_keys(cls) -> tuple[str, ...]:
        """The keys as they are written in the file."""
        return tuple(known.written for known in cls.keys.values())

    def as_data(self, without_none: bool = False) -> dict[str, Any]:
        """The values by attribute, those of sections inside too, as plain data that can be compared."""
        given = vars(self).items()
        return {name: plain(value) for name, value in given if not (without_none and value is None)}


def plain(value: Any) -> Any:
    """Values with plain mappings in place of sections."""
    if isinstance(value, Section):
        return value.as_data()
    if isinstance(value, tuple):
        return tuple(plain(each) for each in value)
    if isinstance(value, dict):
        return {name: plain(each) for name, each in value.items()}
    return value
