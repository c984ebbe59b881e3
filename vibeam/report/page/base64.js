// Bytes from base64, for pages, workers and node.

/** @type {(text: string) => Uint8Array<ArrayBuffer>} */
export function bytesOf(text) {
  const raw = atob(text), bytes = new Uint8Array(raw.length);
  for (let at = 0; at < raw.length; at += 1) bytes[at] = raw.charCodeAt(at);
  return bytes;
}
/** The same of compressed ones. @type {(text: string, format: CompressionFormat) => Promise<ArrayBuffer>} */
export function inflated(text, format) {
  const bytes = new Blob([bytesOf(text)]).stream().pipeThrough(new DecompressionStream(format));
  return new Response(bytes).arrayBuffer();
}
