"""Answers beside the page: in pieces, the newest alone; on the page itself where there is no worker."""

from page_payload import page_payload

import vibeam

START = """const { serve, background } = await load("extensions/explore/engine/worker.js");
const until = async (done) => { while (!done()) await new Promise((resolve) => setTimeout(resolve, 1)); };
let clock = 0; // an engine whose points take a millisecond each, and say where they are
performance.now = () => clock;
const counted = {
  response: (fidelity, place, frequencies, { slowest, states, carried }) => {
    clock += frequencies.length;
    if (place.gap < 0) throw new Error("no such gap");
    return { frequency: frequencies, slowest, begun: states, carried, states: frequencies.map((f) => `after ${f}`) };
  },
  orbits: (fidelity, place, frequencies) => frequencies.length,
};
function asked(engine, budget) {
  const heard = [], port = { postMessage: (answer) => heard.push(answer) };
  return { heard, stop: serve(port, engine, budget), ask: (data) => port.onmessage({ data }) };
}
const frequencies = Array.from({ length: 100 }, (_, i) => 1 + i);
"""


def test_a_curve_comes_in_pieces_as_long_as_the_budget(node):
    heard = node(
        START
        + """const { heard, ask } = asked(counted, 16);
    ask({ id: 5, call: "response", args: ["beam", {}, frequencies, { settle: 1, states: frequencies }] });
    await until(() => heard.at(-1)?.done === 100);
    return heard;"""
    )
    bounds = [(each["from"], each["done"]) for each in heard]
    assert [first for first, _ in bounds[1:]] == [last for _, last in bounds[:-1]]
    assert bounds[0] == (0, 32)
    assert {last - first for first, last in bounds[1:-1]} == {16}  # 16 ms at 1 ms a point
    assert all(each["id"] == 5 and each["of"] == 100 for each in heard)
    assert [f for each in heard for f in each["values"]["begun"]] == list(range(1, 101))
    assert {each["values"]["slowest"] for each in heard} == {2 * 3.141592653589793}


def test_a_newer_question_ends_the_older_one_of_its_kind(node):
    heard = node(
        START
        + """const { heard, ask } = asked(counted, 8);
    ask({ id: 1, call: "response", args: ["beam", {}, frequencies] });
    ask({ id: 2, call: "response", args: ["sdof", {}, frequencies] });
    await until(() => heard.length > 3);
    ask({ id: 3, call: "response", args: ["beam", {}, frequencies] });
    ask({ id: 4, call: "orbits", args: ["beam", {}, frequencies] });
    await until(() => heard.filter(({ done }) => done === 100).length === 2);
    return heard;"""
    )
    of = {number: [each for each in heard if each["id"] == number] for number in (1, 2, 3, 4)}
    assert of[1][-1]["done"] < 100
    assert of[2][-1]["done"] == of[3][-1]["done"] == 100
    assert [each["values"] for each in of[4]] == [100]
    order = [each["id"] for each in heard[:4]]
    assert order in ([1, 2, 1, 2], [2, 1, 2, 1])  # a piece each in turn
    assert heard.index(of[1][-1]) < heard.index(of[3][0])


def test_a_carried_curve_goes_on_from_piece_to_piece(node):
    heard = node(
        START
        + """const { heard, ask } = asked(counted, 16);
    ask({ id: 1, call: "response", args: ["beam", {}, frequencies, { carried: true }] });
    await until(() => heard.some(({ done }) => done === 100));
    return heard;"""
    )
    assert len(heard) > 2
    assert [each["values"]["begun"] for each in heard] == [[]] + [[f"after {each['from']}"] for each in heard[1:]]


def test_a_steady_point_is_answered_before_the_curves_that_wait(node):
    """What the reader looks at, whatever was asked first; the curves go on after it."""
    heard = node(
        START
        + """const { heard, ask } = asked({ ...counted, steady: () => "settled" }, 8);
    for (const id of [1, 2, 3]) ask({ id, call: "response", args: [`model ${id}`, {}, frequencies] });
    ask({ id: 4, call: "steady", args: ["model 3", {}] });
    await until(() => heard.filter(({ done, of }) => done === of).length === 4);
    return heard;"""
    )
    assert [each["id"] for each in heard].index(4) <= 1  # at most the piece that was begun goes before it
    assert {each["id"] for each in heard} == {1, 2, 3, 4}


def test_faults_are_sentences(node):
    heard = node(
        START
        + """const { heard, ask } = asked(counted, 8), none = asked(null, 8);
    ask({ id: 1, call: "response", args: ["beam", { gap: -1 }, frequencies] });
    ask({ id: 2, call: "dance", args: ["beam"] });
    none.ask({ id: 3, call: "orbits", args: ["beam", {}, []] });
    none.ask({ id: 4, call: "open", args: [{}] });
    await until(() => heard.length + none.heard.length === 4);
    return [...heard, ...none.heard];"""
    )
    faults = {each["id"]: each["fault"] for each in heard}
    assert faults[1] == "no such gap"
    assert '"dance"' in faults[2]
    assert "not open yet" in faults[3]
    assert faults[4]


def test_a_silent_worker_is_ended_by_a_newer_question_and_the_others_are_asked_again(node):
    """Workers that open and say nothing more; the second hears what is still asked."""
    workers = node(
        START
        + """const workers = [];
    globalThis.Worker = class {
      constructor() { workers.push(this); this.heard = []; this.ended = false; }
      postMessage({ id, call, args }) {
        this.heard.push(call === "open" ? call : `${id} ${call} ${args[0]}`);
        if (call === "open") setTimeout(() => this.onmessage({ data: { id, done: 1, of: 1 } }), 0);
      }
      terminate() { this.ended = true; }
    };
    const alone = background(counted, {}, ""), ask = (id, name) =>
      alone.postMessage({ id, call: "response", args: [name, {}, frequencies] });
    ask(1, "beam");
    await until(() => workers[0].heard.length === 2);
    ask(2, "sdof");
    ask(3, "two_modes");
    workers[0].onmessage({ data: { id: 3, from: 0, done: 100, of: 100 } });
    ask(4, "beam");
    clock += 2100;
    ask(5, "free");
    ask(6, "beam");
    await until(() => workers.length === 2 && workers[1].heard.length === 4);
    ask(7, "beam");
    return workers.map(({ heard, ended }) => ({ heard, ended }));"""
    )
    first, second = workers
    assert first["ended"]
    assert first["heard"] == [
        "open", "1 response beam", "2 response sdof", "3 response two_modes", "4 response beam", "5 response free",
    ]  # fmt: skip
    assert not second["ended"]
    assert sorted(second["heard"][1:4]) == ["2 response sdof", "5 response free", "6 response beam"]
    assert second["heard"][4] == "7 response beam"


def test_the_page_answers_where_there_is_no_worker(node):
    beam = vibeam.ImpactSystem.from_modes([47.7, 299.0], 0.02, [2.0, -1.0], [0.5, 0.25], gap=1e-3, restitution=0.7)
    there, here = node(
        START
        + """const { open } = await load("extensions/explore/engine/engine.js");
    const engine = await open(given.payload), alone = background(engine, given.payload, ""), heard = [];
    alone.onmessage = ({ data }) => heard.push(data);
    const f = Array.from({ length: 41 }, (_, i) => 6 + 0.4 * i), schedule = { settle: 60, hold: 10, carried: true };
    alone.postMessage({ id: 1, call: "response", args: ["beam", {}, f, schedule] });
    alone.postMessage({ id: 2, call: "orbits", args: ["beam", {}, f] });
    await until(() => heard.filter(({ done, of }) => done === of).length === 2);
    const curve = heard.filter(({ id }) => id === 1).flatMap(({ values }) => [...values.amplitude]);
    const orbits = heard.find(({ id }) => id === 2).values;
    alone.terminate();
    return [
      { where: alone.where, curve, orbits: orbits.length },
      { curve: engine.response("beam", {}, f, schedule).amplitude, orbits: engine.orbits("beam", {}, f).length },
    ];""",
        {"payload": page_payload({"beam": beam}, 1e-3)},
    )
    assert there.pop("where") == "page"
    assert there == here
