// Arrays in the memory that all libraries share, and calls of their functions through 8-byte slots, as flight/engine/call.py.
// Slots of a call: its numbers, room for its results, then every array as its address and the length of each axis.

/** @import { Entry, Kind, Table } from "./types.d.ts" */
/** @typedef {(slots: number) => number} Library */

const ALIGNMENT = 64, PAGE = 65536, WORD = 2 ** 32;

/** An array in the libraries' memory, in C order. */
export class SlotArray {
  /**
   * @param {Slots} slots
   * @param {string} kind f8 or i8
   * @param {number[]} shape
   * @param {number} address
   */
  constructor(slots, kind, shape, address) {
    this.slots = slots;
    this.kind = kind;
    this.shape = shape;
    this.address = address;
    this.size = shape.reduce((product, length) => product * length, 1);
    this.room = this.size;
    /** @type {Float64Array | null} */
    this.view = null;
  }

  /**
   * Its numbers; a view that a later `array` may end, so it is not to be kept.
   * @returns {Float64Array}
   */
  get data() {
    const { buffer } = this.slots.memory;
    if (this.view === null || this.view.buffer !== buffer || this.view.length !== this.size)
      this.view = new Float64Array(buffer, this.address, this.size);
    return this.view;
  }

  /**
   * The same numbers of an array of integers.
   * @returns {BigInt64Array}
   */
  get integers() {
    return new BigInt64Array(this.slots.memory.buffer, this.address, this.size);
  }

  /**
   * Take another shape, within the room that was asked for.
   * @param {number[]} shape
   */
  reshape(shape) {
    const size = shape.reduce((product, length) => product * length, 1);
    if (size > this.room) throw new Error(`an array of ${this.room} numbers has no room for ${size}`);
    this.shape = shape;
    this.size = size;
  }
}

/** The memory of one set of libraries, and their functions. */
export class Slots {
  /**
   * @param {WebAssembly.Memory} memory
   * @param {Table} table
   * @param {Record<string, Library>} functions by name of the entry, as "flight.move"
   */
  constructor(memory, table, functions) {
    this.memory = memory;
    this.rows = table.rows;
    this.entries = table.entries;
    this.functions = functions;
    this.end = table.first;
    /** @type {Map<number, number[]>} addresses of arrays that were given back, by their bytes */
    this.spare = new Map();
    /** @type {Map<string, SlotArray>} */
    this.frames = new Map();
    this.words = new Uint32Array(memory.buffer);
    this.numbers = new Float64Array(memory.buffer);
  }

  /**
   * An array of zeros.
   * @param {string} kind f8 or i8
   * @param {number[]} shape
   * @returns {SlotArray}
   */
  array(kind, shape) {
    const bytes = 8 * shape.reduce((product, length) => product * length, 1);
    const address = this.spare.get(bytes)?.pop() ?? this.reserve(bytes);
    const made = new SlotArray(this, kind, [...shape], address);
    made.data.fill(0);
    return made;
  }

  /**
   * An array of that shape in the room of an earlier one, which it ends, where that is large enough; not cleared. Else
   * its room is a power of two, so that what is given back is used again.
   * @param {SlotArray | undefined} earlier
   * @param {string} kind
   * @param {number[]} shape
   * @returns {SlotArray}
   */
  fitted(earlier, kind, shape) {
    const size = shape.reduce((product, length) => product * length, 1);
    if (earlier && size > earlier.room) this.free(earlier);
    const found = earlier && size <= earlier.room ? earlier : this.array(kind, [2 ** Math.ceil(Math.log2(Math.max(size, 1)))]);
    found.reshape(shape);
    return found;
  }

  /**
   * Give an array back: it is not to be used any more.
   * @param {SlotArray} array
   */
  free(array) {
    const bytes = 8 * array.room, known = this.spare.get(bytes);
    if (known) known.push(array.address);
    else this.spare.set(bytes, [array.address]);
  }

  /**
   * @param {number} bytes
   * @returns {number}
   */
  reserve(bytes) {
    const address = this.end, { buffer } = this.memory;
    this.end = Math.ceil((address + bytes) / ALIGNMENT) * ALIGNMENT;
    if (this.end > buffer.byteLength) {
      const wanted = Math.max(this.end - buffer.byteLength, Math.min(buffer.byteLength, 1 << 25));
      try {
        this.memory.grow(Math.ceil(wanted / PAGE));
      } catch {
        this.end = address;
        throw new Error("This motion needs more memory than there is: take fewer periods, or a model with fewer modes.");
      }
    }
    return address;
  }

  /**
   * Call a library's function; its results. Numbers are given as such, tuples as objects by the names of their fields.
   * @param {string} name as "flight.move"
   * @param {Record<string, any>} values by the names of its arguments
   * @returns {number[]}
   */
  call(name, values) {
    const entry = this.entries[name], made = this.functions[name];
    if (!entry || !made) throw new Error(`this page carries no ${name}`);
    const frame = this.frame(name, entry);
    if (this.words.buffer !== this.memory.buffer) {
      this.words = new Uint32Array(this.memory.buffer);
      this.numbers = new Float64Array(this.memory.buffer);
    }
    let at = frame.address / 8;
    for (const [argument, kind] of entry.arguments)
      if (isNumber(kind)) at = this.put(at, kind, values[argument], argument);
    const results = at;
    at += entry.results.length;
    for (const [argument, kind] of entry.arguments)
      if (!isNumber(kind)) at = this.put(at, kind, values[argument], argument);
    const fault = made(frame.address);
    if (fault) throw new Error(`${name}: the compiled kernel failed (${fault})`);
    return entry.results.map((kind, i) => this.result(results + i, kind));
  }

  /**
   * The slots of a function, always the same ones.
   * @param {string} name
   * @param {Entry} entry
   * @returns {SlotArray}
   */
  frame(name, entry) {
    let found = this.frames.get(name);
    if (!found) {
      const length = entry.results.length + entry.arguments.reduce((sum, [, kind]) => sum + slotsOf(kind), 0);
      this.frames.set(name, found = this.array("f8", [length]));
    }
    return found;
  }

  /**
   * Fill the slots of one argument from `at` on; the slot after them.
   * @param {number} at
   * @param {Kind} kind
   * @param {any} value
   * @param {string} name
   * @returns {number}
   */
  put(at, kind, value, name) {
    if (typeof kind !== "string") {
      for (const [field, each] of kind.fields) at = this.put(at, each, value[field], field);
      return at;
    }
    if (kind === "d") {
      this.numbers[at] = value;
      return at + 1;
    }
    if (kind === "q") return this.whole(at, value);
    const [type, axes] = [kind.slice(0, 2), Number(kind.slice(3))];
    if (!(value instanceof SlotArray) || value.kind !== type || value.shape.length !== axes)
      throw new Error(`${name} needs an array ${type} of ${axes} axes`);
    at = this.whole(at, value.size ? value.address : 0);
    for (const length of value.shape) at = this.whole(at, length);
    return at;
  }

  /**
   * @param {number} at
   * @param {number} value
   * @returns {number}
   */
  whole(at, value) {
    this.words[2 * at] = value >>> 0;
    this.words[2 * at + 1] = Math.floor(value / WORD);
    return at + 1;
  }

  /**
   * @param {number} at
   * @param {string} kind
   * @returns {number}
   */
  result(at, kind) {
    if (kind === "d") return this.numbers[at];
    return this.words[2 * at] + WORD * (this.words[2 * at + 1] | 0);
  }
}

/**
 * @param {Kind} kind
 * @returns {kind is "d" | "q"}
 */
function isNumber(kind) {
  return kind === "d" || kind === "q";
}

/**
 * Number of slots of an argument.
 * @param {Kind} kind
 * @returns {number}
 */
function slotsOf(kind) {
  if (typeof kind !== "string") return kind.fields.reduce((sum, [, each]) => sum + slotsOf(each), 0);
  return isNumber(kind) ? 1 : 1 + Number(kind.slice(3));
}
