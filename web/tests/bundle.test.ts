import { expect, test } from "vitest";
import { decodeBundle, floats, triangles } from "../src/core/bundle";

function packed(header: object, data: number[]): ArrayBuffer {
  let text = JSON.stringify(header);
  while (text.length % 4) text += " ";
  const bytes = new Uint8Array(8 + text.length + data.length);
  bytes.set(new TextEncoder().encode("CXB1"));
  new DataView(bytes.buffer).setUint32(4, text.length, true);
  bytes.set(new TextEncoder().encode(text), 8);
  bytes.set(data, 8 + text.length);
  return bytes.buffer;
}

test("arrays are read where they lie", () => {
  const data = [...new Uint8Array(new Float32Array([1.5, -2]).buffer), ...new Uint8Array(new Uint32Array([0, 1, 2]).buffer)];
  const buffer = packed({ meta: { frame: 3 }, arrays: [
    { name: "values", type: "float32", rows: 2, columns: 1, offset: 0 },
    { name: "triangles", type: "uint32", rows: 1, columns: 3, offset: 8 },
  ] }, data);
  const bundle = decodeBundle(buffer);
  expect(bundle.meta["frame"]).toBe(3);
  expect([...floats(bundle, "values")]).toEqual([1.5, -2]);
  expect([...triangles(bundle)]).toEqual([0, 1, 2]);
  expect(floats(bundle, "values").buffer).toBe(buffer);
});

test("what is no bundle is refused", () => {
  expect(() => decodeBundle(new ArrayBuffer(4))).toThrow("no bundle");
  expect(() => decodeBundle(new TextEncoder().encode("<!doctype").buffer as ArrayBuffer)).toThrow("no bundle");
  expect(() => decodeBundle(packed({ meta: {}, arrays: [{ name: "a", type: "float16", rows: 1, columns: 1, offset: 0 }] }, []))).toThrow("unknown type");
});

test("numbers in steps of 16 bits come as numbers, NaN where there is none", () => {
  const data = [...new Uint8Array(new Uint16Array([0, 2, 65535, 4]).buffer)];
  const bundle = decodeBundle(packed({ meta: {}, arrays: [{ name: "p", type: "steps16", rows: 2, columns: 2, offset: 0, low: -1, step: 0.5 }] }, data));
  expect([...floats(bundle, "p")]).toEqual([-1, 0, NaN, 1]);
});
