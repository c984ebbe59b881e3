// What node.js, the command, takes of node.

declare module "node:fs" {
  export function readFileSync(file: string | number, encoding: "utf8"): string;
}
declare const process: { argv: string[]; stdout: { write(text: string): void } };
