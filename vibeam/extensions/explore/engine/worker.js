// Long answers beside the page: response curves in pieces, orbits, steady points, in a worker with an engine of its
// own. Where the browser refuses workers, the same questions are answered on the page, in slices between its frames.
//
// Asked:    {id, call: "open" | "response" | "orbits" | "steady", args: the arguments of the engine's method}
// Answered: {id, from, done, of, values}: of a response the points from … done, of the others all at once;
//           {id, fault}: the sentence of a refusal.
//
// A newer question of the same call and fidelity ends the older one: a slider that moves leaves nothing behind. Curves
// of several fidelities fill in together, a piece each in turn. No call of a kernel can be ended: where one lasts, as a
// chatter that hardly loses speed, a newer question ends the worker, and another one takes up what is still asked.
import { open } from "./engine.js";

/** @import { Answer, Question } from "./types.d.ts" */
/** @typedef {{postMessage: (answer: Answer) => void, onmessage: ((event: {data: Question}) => void) | null}} Port */
/**
 * The face of a worker, wherever the answers come from.
 * @typedef {{where: "worker" | "page", onmessage: ((event: {data: Answer}) => void) | null,
 *   postMessage: (question: Question) => void, terminate: () => void}} Background
 */
/** @typedef {{id: number, key: string, answers: Iterator<Answer>}} Job */

const IN_WORKER = 24, ON_PAGE = 6; // ms that a piece may take: then newer questions are heard, or a frame is drawn
const FIRST = 32, LANES = 8; // points of the first piece; the kernels fly as many side by side
const LEAST = 0.05; // ms that a piece takes at least
const PATIENCE = 5000; // ms in which a worker must have opened its engine
const SILENCE = 2000; // ms without a word after which a newer question ends the worker

/** @type {Map<string, number>} points of a piece, by call and fidelity, as the last question left them */
const sizes = new Map();

/**
 * Answer the questions that come through a port, until the function returned is called.
 * @param {Port} port
 * @param {any} engine null: the first question opens one
 * @param {number} budget ms a piece
 * @returns {() => void}
 */
export function serve(port, engine = null, budget = IN_WORKER) {
  /** @type {Job[]} */
  const jobs = [];
  /** @type {Map<string, number>} */
  const newest = new Map();
  let running = false;
  const run = () => {
    const job = jobs.shift();
    running = job !== undefined;
    if (!job) return;
    if (newest.get(job.key) === job.id && advanced(job, port)) jobs.push(job);
    setTimeout(run, 0);
  };
  port.onmessage = ({ data: { id, call, args } }) => {
    if (call === "open") {
      open(args[0], args[1]).then(
        (opened) => {
          engine = opened;
          port.postMessage({ id, from: 0, done: 1, of: 1, values: null });
        },
        (fault) => port.postMessage({ id, fault: sentence(fault) }),
      );
      return;
    }
    const key = `${call} ${args[0]}`;
    newest.set(key, id);
    const job = { id, key, answers: answers(engine, { id, call, args }, key, budget) };
    if (call === "steady") jobs.unshift(job); else jobs.push(job); // short, and what the reader waits for
    if (running) return;
    running = true;
    setTimeout(run, 0);
  };
  return () => newest.clear();
}

/**
 * Post a job's next answer; whether there are more to come.
 * @param {Job} job
 * @param {Port} port
 */
function advanced(job, port) {
  try {
    const { value, done } = job.answers.next();
    if (!done) port.postMessage(value);
    return !done;
  } catch (fault) {
    port.postMessage({ id: job.id, fault: sentence(fault) });
    return false;
  }
}

/** @param {unknown} fault */
const sentence = (fault) => (fault instanceof Error ? fault.message : String(fault));

/**
 * The answers to a question, each made when it is asked for.
 * @param {any} engine
 * @param {Question} question
 * @param {string} key
 * @param {number} budget
 * @returns {Generator<Answer, void, void>}
 */
function* answers(engine, { id, call, args }, key, budget) {
  if (!engine) throw new Error("The engine is not open yet: ask again when it is.");
  if (call !== "response") {
    if (call !== "orbits" && call !== "steady") throw new Error(`The engine answers no "${call}" beside the page.`);
    yield { id, from: 0, done: 1, of: 1, values: engine[call](...args) };
    return;
  }
  const [fidelity, place, frequencies, schedule = {}] = args, of = frequencies.length, { carried } = schedule;
  const slowest = 2 * Math.PI * Math.min(...frequencies);
  let size = sizes.get(key) ?? FIRST, from = 0, states = schedule.states ?? [];
  do {
    const done = Math.min(of, from + size), begun = performance.now(), part = frequencies.slice(from, done);
    const values = engine.response(fidelity, place, part, { slowest, ...schedule, states: states.slice(from, done) });
    if (carried) states = Array(done).concat(values.states.slice(-1)); // from where the next piece goes on
    const within = Math.min((budget * (done - from)) / Math.max(performance.now() - begun, LEAST), 4 * size);
    size = within < LANES ? Math.max(1, Math.floor(within)) : LANES * Math.floor(within / LANES);
    sizes.set(key, size);
    yield { id, from, done, of, values };
    from = done;
  } while (from < of);
}

/**
 * A worker with an engine, or the page itself in its place. Questions may be asked at once.
 * @param {any} engine the page's own, whose compiled libraries the worker takes over
 * @param {any} payload
 * @param {string} text the engine's modules and this one as one script
 * @returns {Background}
 */
export function background(engine, payload, text) {
  /** @type {Question[] | null} */
  let waiting = [];
  /** @type {Map<string, Question>} what is asked and not answered yet, the newest by call and fidelity */
  const asked = new Map();
  /** @type {Worker | null} */
  let worker = null;
  let stop = () => {}, heard = 0;
  /** @type {Port} */
  const page = { postMessage: (data) => face.onmessage && face.onmessage({ data }), onmessage: null };
  /** @type {Background} */
  const face = {
    where: "worker",
    onmessage: null,
    postMessage: (question) => {
      const key = `${question.call} ${question.args[0]}`, now = performance.now(), older = asked.get(key);
      if (!asked.size) heard = now;
      asked.set(key, question);
      if (face.where === "page") setTimeout(() => page.onmessage && page.onmessage({ data: question }), 0);
      else if (waiting) waiting.push(question);
      else if (older && older !== question && now - heard > SILENCE) again();
      else if (worker) worker.postMessage(question);
    },
    terminate: () => {
      waiting = null;
      stop();
      page.onmessage = null;
      if (worker) worker.terminate();
    },
  };
  const release = () => {
    const questions = waiting ?? [];
    waiting = null;
    questions.forEach(face.postMessage);
  };
  const refused = () => {
    if (!waiting) return;
    if (worker) worker.terminate();
    face.where = "page";
    stop = serve(page, engine, ON_PAGE);
    release();
  };
  const hear = (/** @type {Answer} */ data) => {
    heard = performance.now();
    if (data.fault !== undefined || data.done === data.of)
      for (const [key, { id }] of asked) if (id === data.id) asked.delete(key);
    if (face.onmessage) face.onmessage({ data });
  };
  const begin = () => {
    try {
      const url = URL.createObjectURL(new Blob([text], { type: "text/javascript" }));
      worker = new Worker(url);
      const late = setTimeout(refused, PATIENCE);
      worker.onerror = refused;
      worker.onmessage = ({ data }) => {
        if (!waiting) return hear(data);
        clearTimeout(late);
        URL.revokeObjectURL(url);
        heard = performance.now();
        if (data.fault) refused();
        else release();
      };
      worker.postMessage({ id: 0, call: "open", args: [{ ...payload, libraries: {} }, engine.modules] });
    } catch {
      refused();
    }
  };
  const again = () => {
    if (worker) worker.terminate();
    waiting = [...asked.values()];
    begin();
  };
  begin();
  return face;
}

if (!("document" in globalThis) && "importScripts" in globalThis) serve(/** @type {any} */ (globalThis));
