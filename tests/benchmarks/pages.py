"""Tables of the benchmark page and of the page of the paper's figures, generated from the committed results.

    python tests/benchmarks/pages.py          # rewrites the tables on both pages
    python tests/benchmarks/pages.py --check  # changes nothing; exit code 1 where a page disagrees with the results

A table stands between ``<!-- begin: NAME -->`` and ``<!-- end: NAME -->``; everything outside these markers is kept.
``against_peers.py`` writes results/peers.json, ``modes.py`` writes results/modes.json, ``printed_stability.py`` writes
results/printed_stability.json, ``paper_methods.py --write`` writes results/paper_methods.json, ``held.py`` writes
results/held.json, ``batches.py`` writes results/batches.json,
``cluster.py`` writes results/cluster.json, ``threads.py`` writes results/threads.json, ``webassembly.py`` writes
results/webassembly.json, ``page_frames.py`` writes results/page_frames.json, ``parts.py`` writes
results/parts.json.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
from collections.abc import Callable, Iterable
from math import floor, log10
from pathlib import Path
from textwrap import fill
from typing import Any

HERE = Path(__file__).parent
PAGE, RESULTS = HERE / "README.md", HERE / "results"
FRONT = HERE.parents[1] / "README.md"
PAPER = HERE.parents[1] / "cases" / "paper" / "README.md"
MAPS = HERE.parents[1] / "vibeam" / "maps" / "README.md"
DAMPINGS = ("constant", "stiffness")
Row = dict[str, Any]


def significant(value: float, digits: int = 2) -> str:
    """``value`` to so many significant digits, without an exponent, thousands apart."""
    if value == 0:
        return "0"
    rounded = float(f"{value:.{digits - 1}e}")
    decimals = digits - 1 - floor(log10(abs(rounded)))
    return f"{rounded:,.{max(decimals, 0)}f}".replace(",", " ")


def power_of_ten(value: float) -> str:
    """``value`` as 2e-15: one significant digit."""
    mantissa, exponent = f"{value:.0e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def markdown(columns: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A Markdown table: first column to the left, all others to the right."""
    titles = list(columns)
    rule = ["---", *["---:"] * (len(titles) - 1)]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in [titles, rule, *map(list, rows)])


def measured(rows: Iterable[Row]) -> list[Row]:
    """The rows that came to a result."""
    return [row for row in rows if "failed" not in row]


def machine_of(section: dict[str, Any]) -> str:
    """Processor, cores, versions and load under which a section was measured."""
    machine, load = section["machine"], section["load"]
    versions = ", ".join(f"{name} {version}" for name, version in machine["versions"].items())
    return fill(
        f"Measured on {machine['cores']} × {machine['processor']}, Python {machine['python']}, {versions}; load "
        f"average {load['before'][0]:.1f} before, {load['after'][0]:.1f} after; medians of {section['rounds']} rounds.",
        width=120,
    )


def peers_table(peers: dict[str, Any], _: list[Row]) -> str:
    """The nominal SDOF sweep: every solver, cost an impact, ratio, errors, impacts missed and invented."""
    section = peers["sdof"]
    rows = (
        [
            row["name"], significant(row["cost_us"]), significant(row["ratio"]), power_of_ten(row["error_median"]),
            power_of_ten(row["error_worst"]), str(row.get("missed", 0)), str(row.get("invented", 0)),
            str(row.get("failed_points", 0)), f"{row['points']} × {row['periods']}",
        ]
        for row in measured(section["rows"])
    )  # fmt: skip
    columns = (
        "solver", "µs an impact", "over flight", "median error", "worst", "missed", "invented", "points given up",
        "points × periods",
    )  # fmt: skip
    return f"{markdown(columns, rows)}\n\n{machine_of(section)}"


def peers_modes_table(peers: dict[str, Any], _: list[Row]) -> str:
    """The DTU rig: flight, the fastest peer and heyoka one frequency at a time, over the number of modes."""
    return markdown(
        ("modes", "flight, µs an impact", "fastest peer", "µs an impact", "over flight", "heyoka, not batched"),
        (_modes_row(section) for name, section in peers.items() if name.startswith("modes-")),
    )


def _modes_row(section: dict[str, Any]) -> list[str]:
    rows = measured(section["rows"])
    flight = next(row for row in rows if row["name"] == "vibeam flight")
    others = [row for row in rows if row["peer"] != "vibeam"]
    fastest = min(others, key=lambda row: float(row["cost_us"]))
    single = [significant(row["ratio"]) for row in others if row["name"] == "heyoka double precision"]
    return [
        str(section["modes"]), significant(flight["cost_us"]), fastest["name"], significant(fastest["cost_us"]),
        significant(fastest["ratio"]), single[0] if single else "–",
    ]  # fmt: skip


def modes_table(_: dict[str, Any], modes: list[Row]) -> str:
    """Cost of an impact and panels a flight over the number of modes, by damping."""
    rows = measured(modes)
    by_damping = [{row["modes"]: row for row in rows if row["damping"] == law} for law in DAMPINGS]
    columns = [f"{law}: {what}" for law in DAMPINGS for what in ("modes lasting", "panels", "µs an impact")]
    sizes = sorted({row["modes"] for row in rows})
    return markdown(["modes", *columns], ([str(n), *_damping_cells(by_damping, n)] for n in sizes))


def _damping_cells(by_damping: Iterable[dict[int, Row]], modes: int) -> Iterable[str]:
    for rows in by_damping:
        row = rows.get(modes)
        if row is None:
            yield from ("–", "–", "–")
        else:
            yield from (str(row["ringing"]), significant(row["panels"]), significant(row["cost_us"]))


def printed_table(rows: list[Row]) -> str:
    """Doubling of period 1 and its misjudgement by the printed forms: a row an R, three columns a gap."""
    gaps = list(dict.fromkeys(row["gap"] for row in rows))
    named = [f"Δ = {1e3 * gap:g}e-3" if gap else "Δ = 0" for gap in gaps]
    columns = [f"{gap}: {what}" for gap in named for what in ("doubles at Ω", "29–30 late", "35–37 late")]
    by_r: dict[float, list[Row]] = {}
    for row in rows:
        by_r.setdefault(row["restitution"], []).append(row)
    return markdown(["R", *columns], ([f"{r:g}", *_printed_cells(own)] for r, own in by_r.items()))


def _printed_cells(rows: Iterable[Row]) -> Iterable[str]:
    for row in rows:
        late = [f"{100 * (row[form] / row['doubling'] - 1):.2f} %" for form in ("29-30", "35-37")]
        yield from (f"{row['doubling']:.4f}", *late)


def read_table(read: dict[str, float]) -> str:
    """Shares of single flights that the printed forms call unstable."""
    return markdown(
        ["form", "flights called unstable"], ([form, f"{100 * share:.0f} %"] for form, share in read.items())
    )


def methods_table(found: dict[str, Any]) -> str:
    """The paper's methods: CPU time, change against direct integration here and in the paper, error."""
    rows, base = found["rows"], found["rows"][0]["seconds"]
    cells = (
        [row["name"], f"{row['seconds']:.2g}", _change(row["seconds"] / base), row["paper"].replace("-", "−"),
         power_of_ten(row["median_error"]) if row["median_error"] else "reference", str(row["evaluations"])]
        for row in rows
    )  # fmt: skip
    columns = ("method", "CPU s", "against direct", "in the paper", "median error", "evaluations")
    return markdown(columns, cells) + f"\n\nLoad average of the machine: {found['load']:.0f}, on two cores."


def _change(ratio: float) -> str:
    return f"{100 * (ratio - 1):+.0f} %".replace("-", "−") if ratio > 0.01 else f"1/{1 / ratio:.0f}"


def startup_table(found: dict[str, Any]) -> str:
    """CPU and wall time of whole commands, and of small calls."""
    whole = ([row["name"], f"{row['cpu']:.2f}", f"{row['wall']:.2f}"] for row in found["commands"])
    small = ([row["name"], significant(1e3 * row["cpu"], 2)] for row in found["calls"])
    first, then = found["load"], found["load_of_calls"]
    text = (
        f"Least of {found['rounds']} rounds of the commands (load average {first['before'][0]:.1f} before, "
        f"{first['after'][0]:.1f} after) and {found['rounds_of_calls']} of the calls ({then['before'][0]:.1f} and "
        f"{then['after'][0]:.1f}), on {found['cores']} cores."
    )
    tables = [markdown(["command", "CPU s", "wall s"], whole), markdown(["call", "CPU ms"], small)]
    return "\n\n".join([*tables, fill(text, width=120)])


def threads_table(found: dict[str, Any]) -> str:
    """Two threads and two processes over one thread, and what a task costs that is too small to share."""
    columns = ["work", "one thread, s", "two threads", "CPU time", "two processes"]
    rows = [
        [row["what"], f"{row['one'][0]:.1f}", *(_between(row[name]) for name in ("ratio", "cpu", "processes"))]
        for row in found["works"].values()
    ]
    tasks, load = found["tasks"], found["load"]
    few = "; ".join(
        f"{count}: {tasks['points'][count][0] / 1e3:.1f} and {tasks['points'][count][1] / 1e3:.1f} ms"
        for count in ("1", "16", "64", "128", "256")
    )
    sooner = (
        f"two threads are sooner from {tasks['from']} points on" if tasks["from"] else "two threads are never sooner"
    )
    text = (
        f"Medians of {found['rounds']} rounds, least and largest in brackets (load average {load['before'][0]:.1f} "
        f"before, {load['after'][0]:.1f} after). To share two tasks that do nothing takes {tasks['call']:.0f} µs. "
        f"Wall times of a few points of one mode over 250 periods, by one thread and by two: {few}; {sooner}."
    )
    return f"{markdown(columns, rows)}\n\n{fill(text, width=120)}"


def _between(values: list[float]) -> str:
    middle, least, most = values
    return f"{middle:.2f} ({least:.2f} … {most:.2f})"


def libraries_table(found: dict[str, Any]) -> str:
    """Cost of an impact by numba and by the libraries of each level, and what a call and loading take."""
    levels = [level for level in found["call"] if level != "numba"]
    over = [f"{level}, {what}" for level in levels for what in ("median ratio", "least over least")]
    rows = (
        [str(row["modes"]), f"{row['ns']['numba']:.0f}",
         *(f"{row[how][level]:.2f}" for level in levels for how in ("median", "least over least"))]
        for row in found["impact"]
    )  # fmt: skip
    call = ", ".join(f"{name} {value:.1f} µs" for name, value in found["call"].items())
    text = (
        f"A call that does nothing: {call}. Opening all libraries: {1e3 * found['ready']['open']:.0f} ms of CPU time "
        f"in a fresh process. {found['rounds']} rounds; load average {found['machine']['load'][0]:.0f} before, "
        f"{found['machine']['load'][1]:.0f} after, on two cores."
    )
    return f"{markdown(['modes', 'numba, ns an impact', *over], rows)}\n\n{fill(text, width=120)}"


def webassembly_table(found: dict[str, Any]) -> str:
    """Times of the same calls by the native libraries and by WebAssembly in node."""
    rows = (
        [row["name"], f"{row['impacts']:,}".replace(",", " "), *(significant(row[key]) for key in ("native", "wasm")),
         f"{row['wasm'] / row['native']:.1f}"]
        for row in found["rows"]
    )  # fmt: skip
    text = (
        f"Node {found['node']}, least of {found['rounds']} rounds; load average {found['machine']['load'][0]:.0f} "
        f"before, {found['machine']['load'][1]:.0f} after, on two cores."
    )
    return f"{markdown(['', 'impacts', 'native, ms', 'WebAssembly, ms', 'ratio'], rows)}\n\n{fill(text, width=120)}"


def flying_table(found: dict[str, Any]) -> str:
    """Bytes and start of pages that fly; frames, curves and orbits in each browser."""
    sizes = (
        [stem, *(f"{found['pages'][stem][part] / 1e3:.0f}" for part in ("page", "kernels")),
         f"{found['pages'][stem]['seconds']:.1f}"]
        for stem in found["pages"]
    )  # fmt: skip
    rows = (_flying_row(name, browser, found["native"]) for browser in found["browsers"] for name in browser["frames"])
    columns = ["", "frames a second", "at work, ms", "in 19 of 20, ms", "121 points, ms", "over native", "orbits, ms"]
    starts = "; ".join(
        f"{each['name']}: first picture {each['first']:.0f} ms after the page is asked for; decoding and compiling the "
        f"kernels {each['open']:.0f} ms"
        for each in found["browsers"]
    )
    load = f"load average {found['load']['before'][0]:.0f} before, {found['load']['after'][0]:.0f} after"
    rounds = f"Starts are medians of {found['rounds']} rounds, frames the best of them"
    rounds += f", curves the least of {found['flights']}; {load}"
    text = f"{starts}. {rounds}, on {found['cores']} cores without a graphics card."
    tables = [markdown(["page", "kB", "of these kernels, kB", "CPU s to write"], sizes), markdown(columns, rows)]
    return "\n\n".join([*tables, fill(text, width=120)])


def _flying_row(name: str, browser: dict[str, Any], native: dict[str, dict[str, float]]) -> list[str]:
    modes = {"sdof": "one mode", "two_modes": "two modes", "beam": "eight modes"}
    frames, flown = browser["frames"][name], browser["flights"].get(name)
    head = [f"{browser['name'].partition('.')[0]}, {modes.get(name, name)}", f"{frames['a second']:.0f}"]
    work = [significant(frames[each]) for each in ("median", "most")]
    if flown is None:
        return [*head, *work, "", "", ""]
    ratio = flown["response"] / native[name]["response"]
    return [*head, *work, significant(flown["response"]), f"{ratio:.1f}", significant(flown["orbits"])]


def parts_table(found: dict[str, Any]) -> str:
    """Maps by one process and by parts, their prices beforehand; what parts take over of other computations."""
    whole, alone = found["whole"], found["alone"]
    sides = [(whole, "one"), (whole, "parts"), (alone, "parts")]
    prices = [(run, which, factor) for run in (whole, alone) for which, factor in PRICES.items()]
    load = " and ".join(f"{each:.0f}" for each in (*whole["load"], *alone["load"]))
    same = {True: "the same to the bit", False: "NOT the same"}
    text = (
        f"The two files of {significant(whole['points'] / 1e6)} million points, {whole['periods']} drive periods each, "
        f"are {same[whole['same']]}; of the {significant(alone['points'] / 1e6)} million, {alone['compared']} of "
        f"{alone['parts']['blocks']['number']} blocks drawn at random and computed by one process are "
        f"{same[alone['same']]}. Signals: {_killed(whole)} and {_killed(alone)} (load averages {load} on "
        f"{alone['processors']} cores)."
    )
    heads = ["", "points", "CPU, min", "of it kept blocks", "beside them", "processes", "files while under way"]
    return "\n\n".join([
        markdown(heads, (_side(run, side) for run, side in sides)),
        fill(text, width=120),
        markdown(
            ["points", "price, core-hours", "core-hours", "price over it", "files", "GB said", "GB"],
            (_priced(run, which, factor) for run, which, factor in prices),
        ),
        markdown(
            ["computation", "case", "CPU, s", "in rounds", ""],
            (_rounds_row(name, each) for name, each in found["rounds"].items()),
        ),
    ])  # fmt: skip


PRICES = {"price": 1, "price of ten times": 10}


def _killed(run: dict[str, Any]) -> str:
    return " and ".join(f"{count} × {name}" for name, count in run["parts"]["killed"].items() if count)


def _side(run: dict[str, Any], side: str) -> list[str]:
    each, killed = run[side], sum(run["parts"]["killed"].values())
    name = "one process" if side == "one" else f"{run['of']} parts, {killed} of them killed once"
    spent = [f"{each['cpu'] / 60:.1f}", f"{each['blocks']['once'] / 60:.1f}", f"{100 * each['beside']:.1f} %"]
    return [name, _millions(run["points"]), *spent, str(each["processes"]), str(each.get("files", "–"))]


def _millions(points: float) -> str:
    return f"{significant(points / 1e6)} million"


def _rounds_row(name: str, found: dict[str, Any]) -> list[str]:
    command, comma, of = name.partition(",")
    shares = {what: 100 * seconds / found["cpu"] for what, seconds in found["rounds"].items()}
    each = ", ".join(f"{what} {share:.0f} %" for what, share in shares.items())
    head = [f"`vibeam {command}`{comma}{of}", f"`cases/{found['case']}`"]
    return [*head, f"{found['cpu']:.1f}", f"{sum(shares.values()):.0f} %", each]


def _priced(run: dict[str, Any], which: str, factor: int) -> list[str]:
    price, seconds = run[which], factor * run.get("one", run["parts"])["cpu"]
    hours = f"{price['seconds'] / 3600:.3g} ± {100 * price['error']:.0f} %"
    took = f"{seconds / 3600:.3g}" + (", ten times those above" if factor > 1 else "")
    size = f"{run['file'] / 1e9:.2f}" if factor == 1 else "–"
    ratio = f"{price['seconds'] / seconds:.2f}"
    return [_millions(price["points"]), hours, took, ratio, str(price["files"]), f"{price['bytes'] / 1e9:.2f}", size]


def sparse_table(found: dict[str, Any]) -> str:
    """CPU time of reading sparse matrices and reducing them."""
    rows = (
        [row["name"], *(f"{row[part]:.2f}" for part in ("read", "modes", "static")), f"{row['megabytes']:.0f}",
         f"{row['error']:.0e}"]
        for row in found["rows"]
    )  # fmt: skip
    columns = ["coordinates", "read, s", "20 modes, s", "static mode, s", "memory, MB", "error of ω²"]
    load = f"Load average {found['load']['before'][0]:.0f} before, {found['load']['after'][0]:.0f} after."
    return f"{markdown(columns, rows)}\n\n{load}"


def solid_table(found: dict[str, Any]) -> str:
    """CPU time and memory of a solid's order, factors and modes, beside one factor by SuperLU."""
    rows = (
        [row["body"], row["by"], f"{row['coordinates']}"]
        + [f"{row[part]:.1f}" if part in row else "–" for part in ("order", "factor", "modes", "gigabytes")]
        for row in found["rows"]
        if "coordinates" in row
    )
    columns = ["body", "factors", "coordinates", "order, s", "factor, s", "20 modes, s", "memory, GB"]
    load = f"Load average {found['load']['before'][0]:.0f} before, {found['load']['after'][0]:.0f} after."
    return f"{markdown(columns, rows)}\n\n{load}"


def scale_table(batches: dict[str, Any], cluster: dict[str, Any]) -> str:
    """Points a second that a core does, measured, and what 1, 16 and 256 cores need for 10⁹ points, predicted."""
    jobs = {
        "DTU rig as in Fig. 18, one mode": batches["rows"]["as Fig. 18, one mode"],
        "the same, eight modes": batches["rows"]["as Fig. 18, eight modes"],
        "gap against frequency, one mode, 11 % aperiodic": batches["rows"]["nominal map, one mode"],
    }
    periods = batches["settle"] + batches["hold"]
    rates = {name: (row["points"] / row["lanes"], periods) for name, row in jobs.items()}
    basins = batches["basins"]
    rates["starts of a basin of attraction, one mode"] = basins["points"] / basins["cpu"], 200
    over = cluster["CPU over that of one thread"]["two workers"]
    columns = ("points", "drive periods each", "a second and core", "1 core", "16 cores", "256 cores")
    return markdown(columns, (_scale_cells(name, *rate, over) for name, rate in rates.items()))


def _scale_cells(name: str, rate: float, periods: int, over: float) -> list[str]:
    seconds = 1e9 / rate
    together = (_lasting(over * seconds / cores) for cores in (16, 256))
    return [name, str(periods), significant(rate), _lasting(seconds), *together]


def _lasting(seconds: float) -> str:
    for unit, size in (("days", 86400.0), ("h", 3600.0)):
        if seconds >= 1.5 * size:
            return f"{significant(seconds / size)} {unit}"
    return f"{significant(seconds / 60)} min"


def front_table(found: dict[str, Any]) -> str:
    """Peaks of the neutral case under both choices of the restitution held."""
    choices = {"first mode": ("R₁ held: R at the contact", "restitution"), "contact": ("R held: R₁", "first_mode")}
    columns = ["fidelity", *(each for named, _ in choices.values() for each in (named, "peak", "against eight modes"))]
    names = [row["name"] for row in found["contact"]["rows"]]
    rows = [
        [name, *(cell for choice, (_, key) in choices.items() for cell in _front_cells(found[choice]["rows"][at], key))]
        for at, name in enumerate(names)
    ]
    return markdown(columns, rows)


def _front_cells(row: dict[str, Any], key: str) -> tuple[str, str, str]:
    return f"{row[key]:.3f}", f"{1e3 * row['peak']:.3f} mm", _off(row["off"]) if row["off"] else "finest"


def _off(share: float) -> str:
    digits = 1 if abs(share) >= 0.01 else 2
    return f"{100 * share:+.{digits}f} %".replace("-", "−")


TABLES: dict[str, Callable[[dict[str, Any], list[Row]], str]] = {
    "peers": peers_table,
    "peers by modes": peers_modes_table,
    "modes": modes_table,
}


def generated(results: Path = RESULTS) -> dict[str, str]:
    """The tables of the benchmark page by name, from the results files in a folder."""
    peers, modes = (_read(results, name) for name in ("peers", "modes"))
    tables = {name: table(peers, modes) for name, table in TABLES.items()}
    single = {
        "libraries": libraries_table,
        "startup": startup_table,
        "threads": threads_table,
        "parts": parts_table,
        "sparse": sparse_table,
        "solid": solid_table,
    }
    single |= {"webassembly": webassembly_table, "page_frames": flying_table}
    return tables | {name: table(_read(results, name)) for name, table in single.items()}


def generated_for_paper(results: Path = RESULTS) -> dict[str, str]:
    """The tables of the page of the paper's figures by name, from the results files in a folder."""
    found = _read(results, "printed_stability")
    return {
        "printed stability": printed_table(found["rows"]),
        "single flights": read_table(found["read"]),
        "methods": methods_table(_read(results, "paper_methods")),
    }


def generated_for_maps(results: Path = RESULTS) -> dict[str, str]:
    """The table of the maps' page by name, from the results files in a folder."""
    return {"scale": scale_table(_read(results, "batches"), _read(results, "cluster"))}


def generated_for_front(results: Path = RESULTS) -> dict[str, str]:
    """The table of the front page by name, from the results files in a folder."""
    return {"held": front_table(_read(results, "held"))}


def _read(results: Path, name: str) -> Any:
    return json.loads((results / f"{name}.json").read_text(encoding="utf-8"))


def with_tables(page: str, tables: dict[str, str]) -> str:
    """``page`` with every table in its place; ValueError names a table whose pair of markers is not there once."""
    for name, table in tables.items():
        begin, end = f"<!-- begin: {name} -->", f"<!-- end: {name} -->"
        block = re.compile(f"{re.escape(begin)}\n.*?{re.escape(end)}", re.DOTALL)
        if len(block.findall(page)) != 1:
            raise ValueError(f"{name}: the page must have {begin} and {end} once, on lines of their own")
        page = block.sub(lambda _, text=f"{begin}\n{table}\n{end}": text, page)
    return page


def main() -> None:
    """Rewrite the pages, or say whether they agree."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="change nothing; exit code 1 where the page disagrees")
    check = parser.parse_args().check
    for place, tables in (
        (PAGE, generated()),
        (PAPER, generated_for_paper()),
        (FRONT, generated_for_front()),
        (MAPS, generated_for_maps()),
    ):
        page = place.read_text(encoding="utf-8")
        renewed = with_tables(page, tables)
        if renewed != page and check:
            sys.exit(f"{place} disagrees with the results: run python tests/benchmarks/pages.py")
        if renewed != page:
            place.write_text(renewed, encoding="utf-8")


if __name__ == "__main__":
    main()
