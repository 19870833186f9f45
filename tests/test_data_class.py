"""Data classes are those of the standard library, in all that can be seen of them."""

from __future__ import annotations

import copy
import dataclasses
import pickle
from typing import Any, ClassVar

import pytest

from contwalk.data_class import dataclass


def _classes(made: Any) -> dict[str, type]:
    """Classes of many kinds, made by a decorator."""

    @made(frozen=True)
    class Frozen:
        a: int
        b: list[int] = dataclasses.field(default_factory=list)
        c: float = 1.5
        kind: ClassVar[str] = "none of the fields"

    @made
    class Open:
        a: int = 0
        hidden: int = dataclasses.field(default=7, repr=False, compare=False)
        later: int = dataclasses.field(init=False)

        def __post_init__(self) -> None:
            self.later = self.a + 1

    @made(frozen=True, eq=False)
    class Identical:
        a: int

    @made(frozen=True, kw_only=True)
    class Named:
        a: int = 3
        b: int

    @made(frozen=True)
    class Derived(Frozen):
        d: str = "d"

    @made(frozen=True, repr=False)
    class OwnText:
        a: int

        def __hash__(self) -> int:
            return 5

    @made(frozen=True)
    class Empty:
        pass

    kinds = (Frozen, Open, Identical, Named, Derived, OwnText, Empty)
    return {kind.__name__: kind for kind in kinds}


OURS, THEIRS = _classes(dataclass), _classes(dataclasses.dataclass)


@pytest.mark.parametrize(
    ("name", "given", "named"),
    [
        ("Frozen", (1,), {}),
        ("Frozen", (1, [2]), {"c": 3.0}),
        ("Frozen", (), {}),
        ("Frozen", (1, [], 2.0, 3), {}),
        ("Frozen", (1,), {"unknown": 2}),
        ("Open", (), {}),
        ("Open", (4, 5), {}),
        ("Named", (), {"b": 2}),
        ("Named", (1,), {"b": 2}),
        ("Derived", (1, [2], 3.0, "x"), {}),
        ("Empty", (), {}),
    ],
)
def test_instances_are_made_of_the_same_arguments(name: str, given: tuple, named: dict) -> None:
    def seen(kind: type) -> Any:
        try:
            made = kind(*given, **named)
        except TypeError as error:
            return str(error)
        return repr(made), vars(made)

    assert seen(OURS[name]) == seen(THEIRS[name])
    assert seen(OURS[name]) == seen(THEIRS[name])  # the first instance has made the initializer


@pytest.mark.parametrize("name", OURS)
def test_fields_equality_and_hashes_are_the_same(name: str) -> None:
    for kinds in (OURS, THEIRS):
        kind = kinds[name]
        assert [f.name for f in dataclasses.fields(kind)] == [
            f.name for f in dataclasses.fields(THEIRS[name])
        ]
    named = {"b": 2} if name == "Named" else {"a": 1} if name == "Identical" or name == "OwnText" else {}
    given = ((2,),) if name in ("Frozen", "Derived") else ()
    one, other, theirs = (
        OURS[name](*given, **named),
        OURS[name](*given, **named),
        THEIRS[name](*given, **named),
    )
    assert (one == other) == (theirs == THEIRS[name](*given, **named))
    assert one != theirs
    assert (kind_hash(one) is None) == (kind_hash(theirs) is None)
    assert dataclasses.replace(one) == one or name == "Identical"


def kind_hash(of: object) -> Any:
    """What a class hashes by."""
    return type(of).__hash__


def test_hashes_are_those_of_the_fields() -> None:
    frozen = OURS["Frozen"]
    assert hash(frozen(1, (2,), 3.0)) == hash(frozen(1, (2,), 3.0)) == hash((1, (2,), 3.0))
    assert hash(OURS["OwnText"](1)) == 5
    with pytest.raises(TypeError, match="unhashable"):
        hash(OURS["Open"]())


@pytest.mark.parametrize("kinds", [OURS, THEIRS])
def test_frozen_ones_cannot_be_changed(kinds: dict[str, Any]) -> None:
    frozen = kinds["Derived"](1)
    for name in ("a", "d", "new"):
        with pytest.raises(dataclasses.FrozenInstanceError, match=f"cannot assign to field '{name}'"):
            setattr(frozen, name, 2)
    with pytest.raises(dataclasses.FrozenInstanceError, match="cannot delete field 'a'"):
        del frozen.a

    class Plain(kinds["Frozen"]):  # type: ignore[misc]
        pass

    plain = Plain(1)
    plain.new = 2
    with pytest.raises(dataclasses.FrozenInstanceError):
        plain.a = 2
    opened = kinds["Open"]()
    opened.a = 9
    assert opened.a == 9


@dataclass(frozen=True)
class Kept:
    """One that is found again by name."""

    a: int
    b: float = 2.0


def test_copies_and_pickles_are_equal() -> None:
    kept = Kept(1)
    assert pickle.loads(pickle.dumps(kept)) == kept == copy.deepcopy(kept)
    assert dataclasses.asdict(kept) == {"a": 1, "b": 2.0}
    assert dataclasses.replace(kept, a=5) == Kept(5)


def test_a_class_may_say_how_it_begins() -> None:
    @dataclass(frozen=True)
    class Begun:
        a: int

        def __init__(self, twice: int) -> None:
            object.__setattr__(self, "a", 2 * twice)

    class Below(Kept):
        def __init__(self) -> None:
            super().__init__(7)

    assert Begun(2).a == 4
    assert Below() == Below()
    assert Below().a == 7
