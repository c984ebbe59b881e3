// What node.js, the command, takes of node.

declare module "node:fs" {
  export function readFileSync(file: string | number, encoding: "utf8"): string;
}
declare const process: {
  argv: string[]; exitCode: number; stdout: { write(text: string): void }; stderr: { write(text: string): void };
};
