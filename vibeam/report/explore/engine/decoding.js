// Arrays and libraries of a payload, from base64.

/**
 * Bytes of a text in base64.
 * @param {string} text
 * @returns {Uint8Array<ArrayBuffer>}
 */
function bytesOf(text) {
  const raw = atob(text), bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) bytes[i] = raw.charCodeAt(i);
  return bytes;
}

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

/**
 * A library from base64 of gzip.
 * @param {string} packed
 * @returns {Promise<ArrayBuffer>}
 */
export function unpacked(packed) {
  return new Response(new Blob([bytesOf(packed)]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
}
