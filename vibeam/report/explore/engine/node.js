// Motions of a page's payload from the command line: node node.js payload.json < requests.json > answers.json.
// A request is {call: "fly" | "settings" | "steady", arguments: [...]}; the answer of one that is refused is {fault}.
import { readFileSync } from "node:fs";
import { open } from "./engine.js";

const [, , path] = process.argv;
const engine = /** @type {any} */ (await open(JSON.parse(readFileSync(path, "utf8"))));
const answers = JSON.parse(readFileSync(0, "utf8")).map((/** @type {{call: string, arguments: any[]}} */ each) => {
  try {
    return engine[each.call](...each.arguments);
  } catch (fault) {
    return { fault: /** @type {Error} */ (fault).message };
  }
});
process.stdout.write(JSON.stringify(answers, (_, value) => (ArrayBuffer.isView(value) ? [.../** @type {any} */ (value)] : value)));
