"""Mutations of a case file's text: bytes, tokens, numbers, units, keys, tables, types, and pieces of other cases.

Each takes a text and a generator of random numbers, and returns a text. A text holds bytes that are not UTF-8 as
lone surrogates (``surrogateescape``).
"""

from __future__ import annotations

import re
from collections.abc import Callable

import numpy as np
from case_texts import blocks, heading, stock, stock_blocks
from mutation_words import CHARACTERS, NUMBERS, TYPES, UNITS

Generator = np.random.Generator
Mutation = Callable[[str, Generator], str]

TOKEN = re.compile(r'"[^"\n]*"|[A-Za-z0-9_.+-]+|[^\sA-Za-z0-9_.+-]|\s+')
NUMBER = re.compile(r"(?<![A-Za-z0-9_.])[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?(?![A-Za-z0-9_.])")
UNIT = re.compile(r'(?<=[0-9] )[A-Za-zµ%][^"\n]*(?=")')
KEY = re.compile(r"^\s*([A-Za-z0-9_\"-]+)\s*=", re.MULTILINE)
VALUE = re.compile(r"^(\s*[A-Za-z0-9_\"-]+\s*=\s*)(.*)$", re.MULTILINE)


def pick(rng: Generator, items: list[str]) -> str:
    """One of the items; empty without any."""
    return items[int(rng.integers(len(items)))] if items else ""


def replaced(pattern: re.Pattern[str], new: Callable[[str], str]) -> Mutation:
    """Mutation that replaces one place where the pattern is found."""

    def mutation(text: str, rng: Generator) -> str:
        found = list(pattern.finditer(text))
        if not found:
            return text
        place = found[int(rng.integers(len(found)))]
        return text[: place.start()] + new(place[0]) + text[place.end() :]

    return mutation


def flip_bits(text: str, rng: Generator) -> str:
    content = bytearray(text.encode("utf-8", "surrogateescape"))
    for _ in range(int(rng.integers(1, 4))):
        content[int(rng.integers(len(content)))] ^= 1 << int(rng.integers(8))
    return content.decode("utf-8", "surrogateescape")


def _span(text: str, rng: Generator) -> tuple[int, int]:
    start = int(rng.integers(len(text)))
    return start, min(len(text), start + int(10 ** rng.uniform(0, 2.5)))


def delete_span(text: str, rng: Generator) -> str:
    start, end = _span(text, rng)
    return text[:start] + text[end:]


def duplicate_span(text: str, rng: Generator) -> str:
    start, end = _span(text, rng)
    return text[:end] + text[start:end] * int(rng.integers(1, 4)) + text[end:]


def truncate(text: str, rng: Generator) -> str:
    return text[: int(rng.integers(1, len(text) + 1))]


def splice(text: str, rng: Generator) -> str:
    """The beginning of one text and the end of another."""
    other = pick(rng, list(stock()))
    return text[: int(rng.integers(1, len(text) + 1))] + other[int(rng.integers(len(other))) :]


def insert_character(text: str, rng: Generator) -> str:
    at = int(rng.integers(len(text)))
    return text[:at] + pick(rng, CHARACTERS) * int(rng.choice([1, 1, 1, 2, 1000])) + text[at:]


def _tokens(text: str, rng: Generator) -> tuple[list[str], int, int]:
    tokens = TOKEN.findall(text)
    return tokens, int(rng.integers(len(tokens))), int(rng.integers(len(tokens)))


def swap_tokens(text: str, rng: Generator) -> str:
    tokens, one, other = _tokens(text, rng)
    tokens[one], tokens[other] = tokens[other], tokens[one]
    return "".join(tokens)


def take_token_from_elsewhere(text: str, rng: Generator) -> str:
    tokens, one, _ = _tokens(text, rng)
    tokens[one] = pick(rng, TOKEN.findall(pick(rng, list(stock_blocks()))))
    return "".join(tokens)


def _lines(text: str, rng: Generator) -> tuple[list[str], int, int]:
    lines = text.splitlines(keepends=True)
    return lines, int(rng.integers(len(lines))), int(rng.integers(len(lines)))


def delete_line(text: str, rng: Generator) -> str:
    lines, one, _ = _lines(text, rng)
    del lines[one]
    return "".join(lines) or "\n"


def duplicate_line(text: str, rng: Generator) -> str:
    lines, one, other = _lines(text, rng)
    lines.insert(other, lines[one])
    return "".join(lines)


def swap_lines(text: str, rng: Generator) -> str:
    lines, one, other = _lines(text, rng)
    lines[one], lines[other] = lines[other], lines[one]
    return "".join(lines)


def delete_table(text: str, rng: Generator) -> str:
    parts = blocks(text)
    del parts[int(rng.integers(len(parts)))]
    return "".join(parts) or "\n"


def duplicate_table(text: str, rng: Generator) -> str:
    """A table once more, under its own name or another."""
    parts = blocks(text)
    copy = pick(rng, parts)
    return text + "\n" + (copy if rng.random() < 0.3 else re.sub(r"\.(\w+)\]", r".\1_again]", copy, count=1))


def swap_tables(text: str, rng: Generator) -> str:
    parts = blocks(text)
    rng.shuffle(parts)
    return "".join(parts)


def add_table(text: str, rng: Generator) -> str:
    return text + "\n" + pick(rng, list(stock_blocks()))


def replace_table(text: str, rng: Generator) -> str:
    """A table as another case, or the template, has it."""
    parts = blocks(text)
    at = int(rng.integers(len(parts)))
    parts[at] = pick(rng, [each for each in stock_blocks() if heading(each) == heading(parts[at])]) or parts[at]
    return "".join(parts)


def add_key(text: str, rng: Generator) -> str:
    """A key that another case, or the template, has in a table of the same kind."""
    parts = blocks(text)
    at = int(rng.integers(len(parts)))
    others = [each for each in stock_blocks() if heading(each) == heading(parts[at])]
    lines = [line for line in pick(rng, others).splitlines() if KEY.match(line)]
    parts[at] = parts[at].rstrip("\n") + "\n" + pick(rng, lines) + "\n\n"
    return "".join(parts)


def change_in_fidelity(text: str, rng: Generator) -> str:
    """A fidelity with physics of its own, or without some of it."""
    block = pick(rng, list(stock_blocks()))
    found = list(VALUE.finditer(block))
    if not found:
        return text
    key = found[int(rng.integers(len(found)))]
    dotted = f"{block.splitlines()[0].strip('[]')}.{key[1].split('=')[0].strip()}"
    value = key[2].split("  #")[0]
    line = f'set = {{ "{dotted}" = {value} }}\n' if rng.random() < 0.7 else f'without = ["{dotted}"]\n'
    places = [each.end() for each in re.finditer(r"^\[fidelity\..*\]\n", text, re.MULTILINE)]
    at = places[int(rng.integers(len(places)))] if places else len(text)
    return text[:at] + line + text[at:]


def change_number(text: str, rng: Generator) -> str:
    return replaced(NUMBER, lambda _: pick(rng, NUMBERS))(text, rng)


def scale_number(text: str, rng: Generator) -> str:
    """A number times 10^x, ten times out of eleven within three decades; its sign now and then the other."""
    width = 3 if rng.random() < 0.9 else 20
    factor = 10 ** rng.uniform(-width, width) * rng.choice([1, 1, 1, -1])
    return replaced(NUMBER, lambda number: f"{float(number) * factor:.6g}")(text, rng)


def nudge_number(text: str, rng: Generator) -> str:
    """A number a little different: to the last bit, by one, rounded, by a tenth."""
    kinds: list[Callable[[float], float]] = [
        lambda x: float(np.nextafter(x, np.inf)), lambda x: x + 1, lambda x: x - 1, np.rint, lambda x: 0.9 * x,
        lambda x: 2 * x, lambda x: x / 2,
    ]  # fmt: skip
    kind = kinds[int(rng.integers(len(kinds)))]
    return replaced(NUMBER, lambda number: f"{kind(float(number)):.17g}")(text, rng)


def change_unit(text: str, rng: Generator) -> str:
    return replaced(UNIT, lambda _: pick(rng, UNITS))(text, rng)


def misspell_key(text: str, rng: Generator) -> str:
    def wrong(line: str) -> str:
        at = int(rng.integers(len(line)))
        return line[:at] + pick(rng, [*"aez_.-", "", '"', " "]) + line[at + 1 :]

    return replaced(KEY, wrong)(text, rng)


def rename_key(text: str, rng: Generator) -> str:
    known = KEY.findall(pick(rng, list(stock())))
    return replaced(KEY, lambda _: f"{pick(rng, known)} =")(text, rng)


def change_type(text: str, rng: Generator) -> str:
    return replaced(VALUE, lambda line: line.split("=")[0] + "= " + pick(rng, TYPES))(text, rng)


def change_value(text: str, rng: Generator) -> str:
    """A key's value as the same key has it elsewhere."""
    found = list(VALUE.finditer(text))
    if not found:
        return text
    place = found[int(rng.integers(len(found)))]
    same = [each[2] for block in stock_blocks() for each in VALUE.finditer(block) if each[1] == place[1]]
    return text[: place.start(2)] + (pick(rng, same) or place[2]) + text[place.end() :]


SYNTAX = (
    flip_bits, delete_span, duplicate_span, truncate, splice, insert_character, swap_tokens, take_token_from_elsewhere,
    delete_line, duplicate_line, swap_lines, misspell_key, rename_key, change_type, change_number,
)  # fmt: skip
CONTENT = (
    delete_table, duplicate_table, swap_tables, add_table, replace_table, add_key, add_key, change_in_fidelity,
    scale_number, scale_number, nudge_number, change_unit, change_value, change_value, change_number, delete_line,
)  # fmt: skip
LINES = (
    flip_bits, delete_span, duplicate_span, truncate, insert_character, swap_tokens, delete_line, duplicate_line,
    swap_lines, change_number, scale_number,
)  # fmt: skip
