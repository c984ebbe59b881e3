"""Effects and contact laws of a user's own: declared like those of vibeam, known to every case file from then on."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from inspect import isabstract
from typing import Any

from vibeam.casefile.tables.cases import case_table
from vibeam.casefile.tables.stop import law_keys, stop_table
from vibeam.casefile.tables.table import NAME, declared_entry
from vibeam_models.effects import EFFECTS
from vibeam_models.keys import Key
from vibeam_models.keys import keys_of as declared_keys
from vibeam_models.laws import LAWS, ContactLaw
from vibeam_models.registry import Home, Registration
from vibeam_models.scene import Effect


def register_effect(effect: type[Effect], repeated: bool = False) -> Registration:
    """Make an effect on the beam known: its table is ``[NAME]``, or ``[[NAME]]`` where it is ``repeated``.

    With a name such as ``"mass.drag"`` it is one key of [mass] or [beam], by the name of its one field.

    It is applied after the effects that are known. ``with register_effect(…):`` or ``remove`` forgets it again.
    ValueError with all that is wrong with the declaration, or for a name that is taken.

    >>> from dataclasses import dataclass
    >>> import vibeam
    >>> from vibeam_models.keys import quantity
    >>> from vibeam_models.scene import Effect
    >>> @dataclass(frozen=True)
    ... class Paint(Effect):
    ...     "A coat of paint damps in proportion to mass; absent = none."
    ...     rate: float = quantity("rad/s", "of the paint", "2 rad/s", above=0)
    ...     name = "paint"
    ...     def apply(self, structure, space, scene):
    ...         return structure.with_(C=structure.C + self.rate * structure.M), space
    >>> with vibeam.register_effect(Paint):
    ...     vibeam.load("cases/dtu_neutral.toml", {"paint.rate": "2 rad/s"}).scene.effects[-1]
    Paint(rate=2.0)
    """
    faults = list(_kind_faults(effect, Effect))
    if not faults:
        above, _, key = effect.name.rpartition(".")
        case = case_table("beam")
        faults += _name_faults(key, (case.KEYS[above].table if above in ("beam", "mass") else case).KEYS)
        if above not in ("", "beam", "mass") or not NAME.fullmatch(key):
            faults.append(f"the name {effect.name!r} must be letters, digits, - or _, after beam. or mass. for a key")
        elif above and [field.name for field in fields(effect)] != [key]:
            faults.append(f"the key {effect.name!r} needs one field, named {key!r}")
        faults += _key_faults(effect)
    _refuse("effect", effect, faults)
    declared = declared_keys(effect)[key] if above else None
    return Registration(EFFECTS, Home(effect.name, effect, repeated, key=declared))


def register_law(law: type[ContactLaw]) -> Registration:
    """Make a contact law known by ``law = "NAME"`` in ``[stop]``, where its fields are keys; as ``register_effect``.

    A key that other laws have must be declared as theirs is (``vibeam_models.laws``).

    >>> from dataclasses import dataclass
    >>> import vibeam
    >>> from vibeam_models.laws import ContactLaw
    >>> from vibeam_models.laws.restitution import Restitution
    >>> @dataclass(frozen=True)
    ... class Rubber(ContactLaw):
    ...     "R = 0.4, whatever the velocity."
    ...     name = "rubber"
    ...     def contact(self, mobility):
    ...         return Restitution(0.4)
    >>> stop = {"stop.law": "rubber", "stop.restitution": None, "stop.restitution_of": "contact"}
    >>> with vibeam.register_law(Rubber):
    ...     vibeam.load("cases/dtu_neutral.toml", stop).system("beam").restitution
    0.4
    """
    faults = list(_kind_faults(law, ContactLaw))
    if not faults:
        faults += _name_faults(law.name, LAWS)
        for form in law.forms():
            faults += [*_key_faults(form), *_shared_faults(form)]
            if isabstract(form):
                faults.append("a method 'contact' is missing: it gives what the solvers run")
    _refuse("contact law", law, faults)
    return Registration(LAWS, Home(law.name, law))


def _refuse(what: str, kind: Any, faults: list[str]) -> None:
    if faults:
        raise ValueError(f"{what} {getattr(kind, '__name__', kind)}: {'; '.join(faults)}")


def _kind_faults(kind: Any, base: type[Any]) -> Iterator[str]:
    if not (isinstance(kind, type) and issubclass(kind, base) and is_dataclass(kind) and kind is not base):
        yield f"must be a frozen dataclass made from {base.__name__}"
    elif not isinstance(getattr(kind, "name", None), str):
        yield "a class variable 'name' is missing: the case file knows it by that"
    elif not kind.__doc__ or kind.__doc__.startswith(f"{kind.__name__}("):
        yield "a docstring is missing: the template explains it by that"


def _name_faults(name: str, known: Any) -> Iterator[str]:
    if name in known:
        yield f"the name {name!r} is taken: there are {', '.join(known)}"


def _key_faults(kind: type[Any]) -> Iterator[str]:
    for field in fields(kind):
        declared = field.metadata.get("key")
        if not isinstance(declared, Key):
            yield f"{field.name}: declare it by quantity or word of vibeam_models.keys"
            continue
        try:
            declared_entry(declared).parse(declared.example)
        except ValueError as error:
            yield f"{field.name}: {error}"


def _shared_faults(form: type[ContactLaw]) -> Iterator[str]:
    known, others = law_keys(), stop_table().KEYS
    for field in fields(form):
        if field.name in known and field.metadata.get("key") != known[field.name]:
            yield f"{field.name}: another law has this key with another meaning: take that one, or another name"
        elif field.name in others and field.name not in known:
            yield f"{field.name}: is a key of every stop: choose another name"
