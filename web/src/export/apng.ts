/** Animated PNG from still ones: an animation without loss that every browser plays (W3C PNG, third edition). */

const kSignature = [137, 80, 78, 71, 13, 10, 26, 10];

const crcTable = Uint32Array.from({ length: 256 }, (_, n) => {
  let c = n;
  for (let k = 0; k < 8; ++k) c = c & 1 ? 0xedb88320 ^ (c >>> 1) : c >>> 1;
  return c >>> 0;
});
export function crc32(bytes: Uint8Array): number {
  let c = 0xffffffff;
  for (const byte of bytes) c = (crcTable[(c ^ byte) & 255] as number) ^ (c >>> 8);
  return (c ^ 0xffffffff) >>> 0;
}

interface Chunk {
  type: string;
  data: Uint8Array;
}

/** @throws Error for bytes that are no PNG */
export function chunksOf(png: Uint8Array): Chunk[] {
  if (!kSignature.every((byte, i) => png[i] === byte)) throw new Error("this is no PNG");
  const view = new DataView(png.buffer, png.byteOffset, png.byteLength);
  const chunks: Chunk[] = [];
  for (let at = 8; at + 12 <= png.length; ) {
    const length = view.getUint32(at);
    const type = String.fromCharCode(...png.subarray(at + 4, at + 8));
    chunks.push({ type, data: png.subarray(at + 8, at + 8 + length) });
    at += 12 + length;
  }
  return chunks;
}

function packed({ type, data }: Chunk): Uint8Array {
  const bytes = new Uint8Array(12 + data.length);
  const view = new DataView(bytes.buffer);
  view.setUint32(0, data.length);
  for (let i = 0; i < 4; ++i) bytes[4 + i] = type.charCodeAt(i);
  bytes.set(data, 8);
  view.setUint32(8 + data.length, crc32(bytes.subarray(4, 8 + data.length)));
  return bytes;
}

const numbers = (...values: number[]): Uint8Array => {
  const bytes = new Uint8Array(4 * values.length);
  const view = new DataView(bytes.buffer);
  values.forEach((value, i) => view.setUint32(4 * i, value));
  return bytes;
};
function joined(...parts: Uint8Array[]): Uint8Array<ArrayBuffer> {
  const bytes = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
  let at = 0;
  for (const part of parts) {
    bytes.set(part, at);
    at += part.length;
  }
  return bytes;
}

/**
 * @param stills PNGs of one size and kind, in order
 * @param milliseconds that each is shown
 * @param loops times it plays; 0: without end
 * @throws Error where the stills differ in size or kind, or there is none
 */
export function animatedPng(stills: Uint8Array[], milliseconds: number, loops = 0): Uint8Array<ArrayBuffer> {
  const pictures = stills.map(chunksOf);
  const head = pictures[0]?.find((chunk) => chunk.type === "IHDR");
  if (!head) throw new Error("an animation needs at least one picture");
  const width = new DataView(head.data.buffer, head.data.byteOffset).getUint32(0);
  const height = new DataView(head.data.buffer, head.data.byteOffset).getUint32(4);
  const delay = Uint8Array.from([(milliseconds >> 8) & 255, milliseconds & 255, 1000 >> 8, 1000 & 255]);
  const parts: Uint8Array[] = [Uint8Array.from(kSignature), packed(head), packed({ type: "acTL", data: numbers(stills.length, loops) })];
  let sequence = 0;
  pictures.forEach((chunks, frame) => {
    const own = chunks.find((chunk) => chunk.type === "IHDR");
    if (!own || !own.data.every((byte, i) => byte === head.data[i])) throw new Error("the pictures of an animation must be of one size and kind");
    parts.push(packed({ type: "fcTL", data: joined(numbers(sequence++, width, height, 0, 0), delay, Uint8Array.from([0, 0])) }));
    for (const { type, data } of chunks) {
      if (type !== "IDAT") continue;
      parts.push(packed(frame === 0 ? { type, data } : { type: "fdAT", data: joined(numbers(sequence++), data) }));
    }
  });
  parts.push(packed({ type: "IEND", data: new Uint8Array() }));
  return joined(...parts);
}
