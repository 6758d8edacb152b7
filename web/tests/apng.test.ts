import { deflateSync, inflateSync } from "node:zlib";
import { describe, expect, test } from "vitest";
import { animatedPng, chunksOf, crc32 } from "../src/export/apng";

const bytes = (...values: number[]): Uint8Array => Uint8Array.from(values);
const word = (value: number): number[] => [24, 16, 8, 0].map((shift) => (value >>> shift) & 255);

/** A PNG of one colour, written by hand: 8 bit grey. */
function png(width: number, height: number, grey: number): Uint8Array {
  const rows = Array.from({ length: height }, () => [0, ...Array.from({ length: width }, () => grey)]).flat();
  const chunk = (type: string, data: Uint8Array): number[] => {
    const body = [...type].map((c) => c.charCodeAt(0)).concat([...data]);
    return [...word(data.length), ...body, ...word(crc32(Uint8Array.from(body)))];
  };
  return bytes(137, 80, 78, 71, 13, 10, 26, 10, ...chunk("IHDR", bytes(...word(width), ...word(height), 8, 0, 0, 0, 0)), ...chunk("IDAT", deflateSync(Uint8Array.from(rows))), ...chunk("IEND", bytes()));
}

describe("an animated PNG", () => {
  test("checks by the CRC of the PNG standard", () => {
    expect(crc32(bytes(...[..."123456789"].map((c) => c.charCodeAt(0))))).toBe(0xcbf43926);
  });
  test("holds every still, in order, each for its time", () => {
    const chunks = chunksOf(animatedPng([png(3, 2, 10), png(3, 2, 20), png(3, 2, 30)], 350, 0));
    expect(chunks.map((c) => c.type)).toEqual(["IHDR", "acTL", "fcTL", "IDAT", "fcTL", "fdAT", "fcTL", "fdAT", "IEND"]);
    expect([...chunks[1]!.data]).toEqual([...word(3), ...word(0)]);
    const sequence = chunks.filter((c) => c.type === "fcTL" || c.type === "fdAT").map((c) => c.data[3]);
    expect(sequence).toEqual([0, 1, 2, 3, 4]);
    const control = chunks[2]!.data;
    expect([...control.subarray(4, 12)]).toEqual([...word(3), ...word(2)]);
    expect([control[20]! * 256 + control[21]!, control[22]! * 256 + control[23]!]).toEqual([350, 1000]);
    const pixels = (data: Uint8Array): number => inflateSync(data)[1]!;
    expect([pixels(chunks[3]!.data), pixels(chunks[5]!.data.subarray(4)), pixels(chunks[7]!.data.subarray(4))]).toEqual([10, 20, 30]);
  });
  test("carries a right check sum in every chunk", () => {
    const all = animatedPng([png(3, 2, 10), png(3, 2, 20)], 100);
    const view = new DataView(all.buffer);
    for (let at = 8; at < all.length; ) {
      const length = view.getUint32(at);
      expect(view.getUint32(at + 8 + length)).toBe(crc32(all.subarray(at + 4, at + 8 + length)));
      at += 12 + length;
    }
  });
  test("refuses what does not belong together", () => {
    expect(() => animatedPng([], 100)).toThrow("at least one");
    expect(() => animatedPng([png(3, 2, 1), png(4, 2, 1)], 100)).toThrow("one size");
    expect(() => animatedPng([bytes(1, 2, 3)], 100)).toThrow("no PNG");
  });
});
