// Arrays of a payload, from base64.
import { bytesOf } from "../../../report/page/base64.js";

/**
 * A payload's value with every array of it decoded, exactly.
 * @param {any} value
 * @returns {any}
 */
export function decoded(value) {
  if (Array.isArray(value)) return value.map(decoded);
  if (value === null || typeof value !== "object") return value;
  if (typeof value.f8 === "string") return new Float64Array(bytesOf(value.f8).buffer);
  return Object.fromEntries(Object.entries(value).map(([name, each]) => [name, decoded(each)]));
}
