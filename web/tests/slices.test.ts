import { expect, test } from "vitest";
import type { Vec3 } from "../src/core/case";
import { contour } from "../src/slices/contour";
import { sliceCorners } from "../src/slices/slice_planes";
import { drawSlice, gridAxes, indexOf, placeOf, sliceAxes, type Volume } from "../src/slices/volume";

const c = Math.cos(0.2);
const s = Math.sin(0.2);
/** Grid axes: first to the front (-P), second up (S), third to the left (L), turned a little about the last. */
function volume(): Volume {
  return {
    size: [4, 3, 2],
    spacing: [1, 2, 3],
    origin: [10, 20, 30],
    direction: [[0, -c, s], [0, s, c], [1, 0, 0]],
    voxels: Uint16Array.from({ length: 24 }, (_, i) => i),
    low: -5,
    step: 1,
    window: [-5, 18],
  };
}

test("index and place are inverse", () => {
  const place: Vec3 = [11.5, 18, 33];
  const back = placeOf(volume(), indexOf(volume(), place));
  place.forEach((value, i) => expect(back[i]).toBeCloseTo(value));
});
test("anatomical axes find the grid axes most along them", () => {
  expect(gridAxes(volume().direction)).toEqual([2, 0, 1]);
  expect(gridAxes([[1, 0, 0], [0, 1, 0], [0, 0, 1]])).toEqual([0, 1, 2]);
});
test("axial slices have the patient's right on the left and the front at the top", () => {
  const axes = sliceAxes(volume(), "axial");
  // grid axis 0 runs to the front: downwards in the picture it must run backwards
  expect(axes).toEqual({ u: 2, v: 0, w: 1, flipU: false, flipV: true });
});
test("coronal slices have the head at the top", () => {
  expect(sliceAxes(volume(), "coronal")).toEqual({ u: 2, v: 1, w: 0, flipU: false, flipV: true });
});
test("a slice holds the voxels of its grid, windowed", () => {
  const pixels = new Uint8ClampedArray(4 * 2 * 4);
  drawSlice(volume(), sliceAxes(volume(), "axial"), 1, [-5, 250], pixels);
  // top left: first along u (grid 2 = 0), last along v (grid 0 = 3), slice 1: voxel 3 + 4 * 1
  expect([...pixels.slice(0, 4)]).toEqual([7, 7, 7, 255]);
  expect(pixels[4]).toBe(7 + 12);
  expect(pixels[8]).toBe(6);
});
test("voxels outside the window are black or white", () => {
  const pixels = new Uint8ClampedArray(4 * 2 * 4);
  drawSlice(volume(), sliceAxes(volume(), "axial"), 0, [0, 1], pixels);
  expect(pixels.some((value) => value === 0)).toBe(true);
  drawSlice(volume(), sliceAxes(volume(), "axial"), 1, [-100, -50], pixels);
  expect([...pixels].every((value) => value === 255)).toBe(true);
});
test("512 x 512 x 200: a slice is ready in every direction", () => {
  const big: Volume = { ...volume(), size: [512, 512, 200], voxels: new Uint16Array(512 * 512 * 200) };
  for (const orientation of ["axial", "coronal", "sagittal"] as const) {
    const axes = sliceAxes(big, orientation);
    const pixels = new Uint8ClampedArray(4 * big.size[axes.u] * big.size[axes.v]);
    const times = Array.from({ length: 15 }, (_, k) => {
      const start = performance.now();
      drawSlice(big, axes, 50 + k, [0, 100], pixels);
      return performance.now() - start;
    }).sort((a, b) => a - b);
    console.log(`${orientation} slice of ${big.size.join(" x ")}: median ${times[7]?.toFixed(1)} ms`);
    expect(pixels[3]).toBe(255);
  }
});
test("a tetrahedron is cut in a triangle of known length, whatever vertices lie on the plane", () => {
  const points = new Float32Array([0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, 2]);
  const faces = new Uint32Array([0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3]);
  const total = (level: number): number => {
    const p = contour(points, faces, 2, level);
    let sum = 0;
    for (let i = 0; i < p.length; i += 6) sum += Math.hypot((p[i] ?? 0) - (p[i + 3] ?? 0), (p[i + 1] ?? 0) - (p[i + 4] ?? 0), (p[i + 2] ?? 0) - (p[i + 5] ?? 0));
    return sum;
  };
  expect(total(1)).toBeCloseTo(2 + Math.SQRT2);
  expect(total(0)).toBeCloseTo(0); // vertices on the plane count as above: nothing lies below
  expect(total(2)).toBeCloseTo(0);
  expect(total(3)).toBe(0);
});
test("a slice stands in the view where it was taken: its corners are those of the picture", () => {
  const v = volume();
  const axes = sliceAxes(v, "axial"); // left to right: towards the left (L); top to bottom: to the back (P)
  const [topLeft, topRight, bottomLeft, bottomRight] = sliceCorners(v, axes, 1);
  expect(topRight[0] - topLeft[0]).toBeCloseTo(2 * 3);
  expect(bottomLeft[1] - topLeft[1]).toBeCloseTo(4 * c);
  topLeft.forEach((x, i) => expect(x + (bottomRight[i] ?? 0)).toBeCloseTo((topRight[i] ?? 0) + (bottomLeft[i] ?? 0)));
  // half a voxel outside the first voxel's centre
  expect(indexOf(v, topLeft)[2]).toBeCloseTo(-0.5);
  expect(indexOf(v, topLeft)[1]).toBeCloseTo(1);
});
