import { expect, test } from "vitest";
import { fillTriangles } from "../src/charts/raster";

const colours = Uint32Array.from([10, 11, 12, 99]); // shares 0, 0.5, 1, and none

test("two triangles fill a square without a gap, values run across it", () => {
  const pixels = new Uint32Array(36);
  const xy = new Float32Array([1, 1, 4, 1, 4, 4, 1, 4]);
  fillTriangles(pixels, 6, xy, [0, 1, 2, 0, 3, 2], new Float32Array([0, 1, 1, 0]), colours);
  const rows = Array.from({ length: 6 }, (_, y) => [...pixels.slice(6 * y, 6 * y + 6)]);
  expect(rows[0]).toEqual([0, 0, 0, 0, 0, 0]);
  for (const row of rows.slice(1, 5)) {
    expect(row[0]).toBe(0);
    expect(row[1]).toBe(10);
    expect(row[4]).toBe(12);
    expect(row[5]).toBe(0);
    expect(row.slice(1, 5).every((colour) => colour > 0)).toBe(true);
  }
});
test("a corner without a value has the colour of none, what lies outside the picture is left", () => {
  const pixels = new Uint32Array(9);
  fillTriangles(pixels, 3, new Float32Array([-5, -5, 20, -5, -5, 20]), [0, 1, 2], new Float32Array([NaN, 0, 0]), colours);
  expect([...pixels].every((colour) => colour === 99)).toBe(true);
});
