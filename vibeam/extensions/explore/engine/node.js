// Motions of a page from the command line: node node.js page.html < requests.json > answers.json; a payload by itself,
// as JSON, does too. Requests are a list of {call: "fly", arguments: [...]}; one that is refused is answered by {fault}.
import { readFileSync } from "node:fs";
import { open } from "./engine.js";

const CALLS = ["fly", "settings", "steady", "response", "orbits"];
const USAGE = "node node.js PAGE.html < REQUESTS.json, a list of {call, arguments}";

/** @type {(file: string | number, what: string, take: (text: string) => string) => any} */
function read(file, what, take) {
  try {
    return JSON.parse(take(readFileSync(file, "utf8")));
  } catch (fault) {
    throw new Error(`${what} cannot be read (${/** @type {Error} */ (fault).message}): ${USAGE}`);
  }
}

/** @type {(text: string) => string} */
function payloadOf(text) {
  return /<script id="engine" type="application\/json">(.*?)<\/script>/s.exec(text)?.[1] ?? text;
}

/** @type {(engine: any, request: {call: string, arguments: any[]}) => any} */
function answer(engine, request) {
  try {
    if (!CALLS.includes(request?.call)) throw new Error(`No call ${request?.call}: there are ${CALLS.join(", ")}.`);
    return engine[request.call](...(request.arguments ?? [{}]));
  } catch (fault) {
    return { fault: /** @type {Error} */ (fault).message };
  }
}

try {
  const page = read(process.argv[2] ?? "", "The page", payloadOf), requests = read(0, "The list of requests", String);
  if (!Array.isArray(requests)) throw new Error(`The requests are no list: ${USAGE}`);
  const engine = await open(page), answers = requests.map((each) => answer(engine, each));
  const plain = (/** @type {string} */ _, /** @type {any} */ value) => (ArrayBuffer.isView(value) ? [.../** @type {any} */ (value)] : value);
  process.stdout.write(`${JSON.stringify(answers, plain)}\n`);
} catch (fault) {
  process.stderr.write(`${/** @type {Error} */ (fault).message}\n`);
  process.exitCode = 1;
}
