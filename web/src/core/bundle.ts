/** Arrays as the server packs them (include/coxa/serve/bundle.h): read where they lie, not copied. */

export type Values = Float32Array | Uint32Array | Uint16Array | Uint8Array;

export interface Bundle {
  meta: Record<string, unknown>;
  arrays: Map<string, Values>;
  bytes: number; // that it came in
}

interface Entry {
  name: string;
  type: string;
  rows: number;
  columns: number;
  offset: number;
  low?: number; // of numbers in steps
  step?: number;
}

const kNoNumber = 65535;

/** Numbers that came in 16 bits. */
function fromSteps(steps: Uint16Array, low: number, step: number): Float32Array {
  const values = new Float32Array(steps.length);
  for (let i = 0; i < steps.length; ++i) {
    const q = steps[i] as number;
    values[i] = q === kNoNumber ? NaN : low + step * q;
  }
  return values;
}

function view(buffer: ArrayBuffer, start: number, entry: Entry): Values {
  const length = entry.rows * entry.columns;
  switch (entry.type) {
    case "float32":
      return new Float32Array(buffer, start, length);
    case "uint32":
      return new Uint32Array(buffer, start, length);
    case "uint16":
      return new Uint16Array(buffer, start, length);
    case "steps16":
      return fromSteps(new Uint16Array(buffer, start, length), entry.low ?? 0, entry.step ?? 1);
    case "uint8":
      return new Uint8Array(buffer, start, length);
    default:
      throw new Error(`a bundle holds an array of unknown type ${entry.type}`);
  }
}

export function decodeBundle(buffer: ArrayBuffer): Bundle {
  const bytes = new DataView(buffer);
  if (buffer.byteLength < 8 || bytes.getUint32(0) !== 0x43584231) throw new Error("this is no bundle");
  const length = bytes.getUint32(4, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 8, length))) as {
    meta: Record<string, unknown>;
    arrays: Entry[];
  };
  const arrays = new Map<string, Values>();
  for (const entry of header.arrays) arrays.set(entry.name, view(buffer, 8 + length + entry.offset, entry));
  return { meta: header.meta, arrays, bytes: buffer.byteLength };
}

export function floats(bundle: Bundle, name: string): Float32Array {
  const values = bundle.arrays.get(name);
  if (!(values instanceof Float32Array)) throw new Error(`the bundle holds no numbers ${name}`);
  return values;
}

export function triangles(bundle: Bundle): Uint32Array {
  const values = bundle.arrays.get("triangles");
  if (!(values instanceof Uint32Array)) throw new Error("the bundle holds no triangles");
  return values;
}
