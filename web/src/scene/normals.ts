/** Vertex normals, weighted by area, into `normals`; a vertex without area gets none. */
export function vertexNormals(positions: Float32Array, triangles: Uint32Array, normals: Float32Array): void {
  normals.fill(0);
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * (triangles[t] as number);
    const b = 3 * (triangles[t + 1] as number);
    const c = 3 * (triangles[t + 2] as number);
    const ax = positions[a] as number;
    const ay = positions[a + 1] as number;
    const az = positions[a + 2] as number;
    const ux = (positions[b] as number) - ax;
    const uy = (positions[b + 1] as number) - ay;
    const uz = (positions[b + 2] as number) - az;
    const vx = (positions[c] as number) - ax;
    const vy = (positions[c + 1] as number) - ay;
    const vz = (positions[c + 2] as number) - az;
    const nx = uy * vz - uz * vy;
    const ny = uz * vx - ux * vz;
    const nz = ux * vy - uy * vx;
    // written out: a loop over the three corners would make a list a triangle
    normals[a] = (normals[a] as number) + nx;
    normals[a + 1] = (normals[a + 1] as number) + ny;
    normals[a + 2] = (normals[a + 2] as number) + nz;
    normals[b] = (normals[b] as number) + nx;
    normals[b + 1] = (normals[b + 1] as number) + ny;
    normals[b + 2] = (normals[b + 2] as number) + nz;
    normals[c] = (normals[c] as number) + nx;
    normals[c + 1] = (normals[c + 1] as number) + ny;
    normals[c + 2] = (normals[c + 2] as number) + nz;
  }
  for (let v = 0; v < normals.length; v += 3) {
    const x = normals[v] as number;
    const y = normals[v + 1] as number;
    const z = normals[v + 2] as number;
    const square = x * x + y * y + z * z;
    if (square === 0) continue;
    const scale = 1 / Math.sqrt(square);
    normals[v] = x * scale;
    normals[v + 1] = y * scale;
    normals[v + 2] = z * scale;
  }
}
