import { Triangle, Vector3 } from "three";
import type { Vec3 } from "../src/core/case";

/** From a place to the nearest point of a surface, all triangles looked at. */
export function distanceTo(points: Float32Array, triangles: Uint32Array, place: Vec3): number {
  const from = new Vector3(...place);
  const triangle = new Triangle();
  const nearest = new Vector3();
  const corner = (i: number, into: Vector3): Vector3 => into.fromArray(points, 3 * (triangles[i] ?? 0));
  let least = Infinity;
  for (let t = 0; t < triangles.length; t += 3) {
    corner(t, triangle.a);
    corner(t + 1, triangle.b);
    corner(t + 2, triangle.c);
    least = Math.min(least, triangle.closestPointToPoint(from, nearest).distanceTo(from));
  }
  return least;
}
