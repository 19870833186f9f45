"""Sections of run files: values in their forms, and all that is wrong at once, each where it stands."""

from __future__ import annotations

import pytest

from contwalk.workflow.run_file.faults import Invalid, wrong
from contwalk.workflow.run_file.forms import list_of, mapping_of, one_of, text, whole
from contwalk.workflow.run_file.section import Section, key


class Wheel(Section):
    radius: int = key(whole(1, 9), "1 to 9")
    side: str = key(one_of("left", "right"), "left or right", "left")
    from_: str | None = key(text, "a text", None, written="from")

    def fit(self):
        if self.radius == 4 and self.side == "right":
            raise wrong("does not turn.", "Turn it.")


class Car(Section):
    wheels: tuple[Wheel, ...] = key(list_of(Wheel.read), "a list of wheels", (), inside=Wheel)
    spare: Wheel | None = key(Wheel, "a wheel", None)
    names: dict[str, str] = key(mapping_of(text), "{name: text}", {})


def faults(section, data):
    with pytest.raises(Invalid) as caught:
        section.read(data)
    return [(fault.at, fault.sentence, fault.remedy) for fault in caught.value.faults]


def test_values_and_defaults():
    car = Car.read({"wheels": {"radius": 3, "from": "here"}, "names": {"a": "b"}, "spare": None})
    assert car.as_data() == {
        "wheels": ({"radius": 3, "side": "left", "from_": "here"},),
        "spare": None,
        "names": {"a": "b"},
    }
    assert Car().as_data(without_none=True) == {"wheels": (), "names": {}}
    assert Car().names is not Car().names
    assert Wheel.known_keys() == ("radius", "side", "from")


def test_all_that_is_wrong_is_told_where_it_stands():
    data = {"wheels": [{"radius": 0}, {"side": "Left"}, 5], "names": {"a": 1}, "colour": "red"}
    assert faults(Car, data) == [
        (("wheels", 0, "radius"), "is 0.", "Allowed: 1 to 9."),
        (("wheels", 1, "radius"), "the key is missing.", "Allowed: 1 to 9."),
        (("wheels", 1, "side"), "is the text 'Left'.", "Allowed: left, right. Did you mean 'left'?"),
        (("wheels", 2), "is 5, which is not a mapping {key: value}.", "Allowed: a list of wheels."),
        (("names", "a"), "is 1, which is not a text.", "Allowed: {name: text}."),
        (("colour",), "unknown key.", ""),
    ]


def test_what_does_not_fit_is_asked_of_values_that_are_right():
    assert faults(Car, {"spare": {"radius": 4, "side": "right"}}) == [
        (("spare",), "does not turn.", "Turn it.")
    ]
    assert len(faults(Car, {"spare": {"radius": 4.0, "side": "right"}})) == 1


@pytest.mark.parametrize("value", [True, 3.0, "3", [3], None])
def test_a_whole_number_is_one(value):
    with pytest.raises(Invalid):
        whole(1)(value)


def test_a_section_stays_as_it_was_read():
    with pytest.raises(AttributeError, match="stays as it is"):
        Wheel.read({"radius": 1}).radius = 2
