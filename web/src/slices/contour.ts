/**
 * Where a triangle surface meets the plane coordinate[axis] = level.
 * @param points x y z per vertex (index coordinates)
 * @returns ends of line pieces: six numbers each
 */
export function contour(points: Float32Array, triangles: Uint32Array, axis: 0 | 1 | 2, level: number): number[] {
  const pieces: number[] = [];
  const cut: number[] = [];
  for (let t = 0; t < triangles.length; t += 3) {
    cut.length = 0;
    for (let k = 0; k < 3; ++k) {
      const a = 3 * (triangles[t + k] ?? 0);
      const b = 3 * (triangles[t + ((k + 1) % 3)] ?? 0);
      const da = (points[a + axis] ?? 0) - level;
      const db = (points[b + axis] ?? 0) - level;
      // a vertex right on the plane counts as above: every crossing is found once
      if (da < 0 === db < 0) continue;
      const s = da / (da - db);
      for (let c = 0; c < 3; ++c) cut.push((points[a + c] ?? 0) + s * ((points[b + c] ?? 0) - (points[a + c] ?? 0)));
    }
    if (cut.length === 6) pieces.push(...cut);
  }
  return pieces;
}
