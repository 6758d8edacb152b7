import { writeFileSync } from "node:fs";
import type { Clock, Vec3 } from "../src/core/case";
import { plus, times } from "../src/core/dots";

/** Where a ring of tissue lies about the socket's axis, mm. */
export interface Ring {
  radius: number; // of the circle that the tube follows
  tube: number; // its own
  out: number; // of the joint centre, along the axis out of the socket
}

const kAlong = 72;
const kAround = 16;

/** Writes a closed surface in the labrum's place, as VTP. */
export function writeRing(file: string, clock: Clock, { radius, tube, out }: Ring): void {
  const points: Vec3[] = [];
  const triangles: number[][] = [];
  const at = (i: number, j: number): number => (i % kAlong) * kAround + (j % kAround);
  for (let i = 0; i < kAlong; ++i) {
    const turn = (2 * Math.PI * i) / kAlong;
    const outward = plus(times(Math.cos(turn), clock.twelve), times(Math.sin(turn), clock.three));
    for (let j = 0; j < kAround; ++j) {
      const tilt = (2 * Math.PI * j) / kAround;
      const arm = plus(times(radius + tube * Math.cos(tilt), outward), times(out + tube * Math.sin(tilt), clock.axis));
      points.push(plus(clock.centre, arm));
      triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
    }
  }
  if (signedVolume(points, triangles) < 0) triangles.forEach((corners) => corners.reverse());
  const array = (type: string, name: string, components: number, values: number[]): string =>
    `<DataArray type="${type}" Name="${name}" NumberOfComponents="${components}" format="ascii">${values.join(" ")}</DataArray>`;
  writeFileSync(
    file,
    `<?xml version="1.0"?>
<VTKFile type="PolyData" version="0.1" byte_order="LittleEndian"><PolyData>
<Piece NumberOfPoints="${points.length}" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="${triangles.length}">
<Points>${array("Float64", "Points", 3, points.flat())}</Points>
<Polys>${array("Int32", "connectivity", 1, triangles.flat())}${array("Int32", "offsets", 1, triangles.map((_, k) => 3 * (k + 1)))}</Polys>
</Piece></PolyData></VTKFile>
`,
  );
}

function signedVolume(points: Vec3[], triangles: number[][]): number {
  let sum = 0;
  for (const [a = 0, b = 0, c = 0] of triangles) {
    const [p, q, r] = [points[a]!, points[b]!, points[c]!];
    sum += p[0] * (q[1] * r[2] - q[2] * r[1]) - p[1] * (q[0] * r[2] - q[2] * r[0]) + p[2] * (q[0] * r[1] - q[1] * r[0]);
  }
  return sum / 6;
}
