import { expect, test } from "vitest";
import { vertexNormals } from "../src/scene/normals";

/** A ball of n by n squares: vertices and triangles of about the boundary of so many tetrahedra. */
function ball(n: number): { positions: Float32Array; triangles: Uint32Array } {
  const positions = new Float32Array(3 * n * n);
  for (let i = 0; i < n; ++i) {
    for (let j = 0; j < n; ++j) {
      const a = (Math.PI * (i + 0.5)) / n;
      const b = (2 * Math.PI * j) / n;
      positions.set([Math.sin(a) * Math.cos(b), Math.sin(a) * Math.sin(b), Math.cos(a)], 3 * (n * i + j));
    }
  }
  const triangles: number[] = [];
  for (let i = 0; i + 1 < n; ++i) {
    for (let j = 0; j < n; ++j) {
      const k = (j + 1) % n;
      triangles.push(n * i + j, n * (i + 1) + j, n * (i + 1) + k, n * i + j, n * (i + 1) + k, n * i + k);
    }
  }
  return { positions, triangles: Uint32Array.from(triangles) };
}

test("normals of a ball point out of it", () => {
  const { positions, triangles } = ball(40);
  const normals = new Float32Array(positions.length);
  vertexNormals(positions, triangles, normals);
  for (let v = 3 * 40; v < positions.length - 3 * 40; v += 3) {
    const along = [0, 1, 2].reduce((sum, c) => sum + (positions[v + c] ?? 0) * (normals[v + c] ?? 0), 0);
    expect(along).toBeGreaterThan(0.99);
  }
});
test("normals of 20 000 vertices are quick", () => {
  const { positions, triangles } = ball(142);
  const normals = new Float32Array(positions.length);
  const times = Array.from({ length: 20 }, () => {
    const start = performance.now();
    vertexNormals(positions, triangles, normals);
    return performance.now() - start;
  }).sort((a, b) => a - b);
  console.log(`normals of ${positions.length / 3} vertices, ${triangles.length / 3} triangles: ${times[10]?.toFixed(2)} ms`);
  expect(times[0]).toBeLessThan(15);
});
