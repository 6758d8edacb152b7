import type { Bundle } from "../core/bundle";
import type { Vec3 } from "../core/case";

/** A scalar image on an oblique grid, LPS mm; voxel centres at integer index, x fastest. */
export interface Volume {
  size: Vec3;
  spacing: Vec3;
  origin: Vec3;
  direction: [Vec3, Vec3, Vec3]; // the grid's unit axes
  voxels: Uint16Array;
  low: number; // value = low + step * voxel
  step: number;
  window: [number, number]; // first window, as values
}

export function volumeFrom(bundle: Bundle): Volume {
  const meta = bundle.meta as unknown as Omit<Volume, "direction" | "voxels"> & { direction_columns: number[] };
  const d = meta.direction_columns;
  const voxels = bundle.arrays.get("voxels");
  if (!(voxels instanceof Uint16Array)) throw new Error("the image holds no voxels");
  const columnAt = (c: number): Vec3 => [d[3 * c] ?? 0, d[3 * c + 1] ?? 0, d[3 * c + 2] ?? 0];
  return { ...meta, voxels, direction: [columnAt(0), columnAt(1), columnAt(2)] };
}

/** Index (with fractions) of a place. */
export function indexOf(volume: Volume, place: Vec3): Vec3 {
  const d: Vec3 = [place[0] - volume.origin[0], place[1] - volume.origin[1], place[2] - volume.origin[2]];
  return [0, 1, 2].map((axis) => {
    const a = volume.direction[axis as 0 | 1 | 2];
    return (a[0] * d[0] + a[1] * d[1] + a[2] * d[2]) / volume.spacing[axis as 0 | 1 | 2];
  }) as Vec3;
}

export function placeOf(volume: Volume, index: Vec3): Vec3 {
  const p: Vec3 = [...volume.origin];
  for (const axis of [0, 1, 2] as const) {
    for (const c of [0, 1, 2] as const) p[c] += volume.direction[axis][c] * volume.spacing[axis] * index[axis];
  }
  return p;
}

export type Orientation = "axial" | "coronal" | "sagittal";
export type Axis = 0 | 1 | 2;

/** Which grid axis runs along which side of a slice's picture, and whether backwards. */
export interface SliceAxes {
  u: Axis; // picture left to right
  v: Axis; // picture top to bottom
  w: Axis; // through the slices
  flipU: boolean;
  flipV: boolean;
}

/** Anatomical axes (L, P, S) to grid axes: each the one most along it, none twice. */
export function gridAxes(direction: [Vec3, Vec3, Vec3]): [Axis, Axis, Axis] {
  const orders: [Axis, Axis, Axis][] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
  const score = (o: [Axis, Axis, Axis]): number => Math.abs(direction[o[0]][0]) + Math.abs(direction[o[1]][1]) + Math.abs(direction[o[2]][2]);
  return orders.reduce((best, o) => (score(o) > score(best) + 1e-9 ? o : best));
}

/** Radiological: the patient's right on the picture's left; anterior or superior at the top; sagittal: anterior left. */
export function sliceAxes(volume: Volume, orientation: Orientation): SliceAxes {
  const [l, p, s] = gridAxes(volume.direction);
  const along = (axis: Axis, anatomical: Axis): boolean => volume.direction[axis][anatomical] > 0;
  if (orientation === "axial") return { u: l, v: p, w: s, flipU: !along(l, 0), flipV: !along(p, 1) };
  if (orientation === "coronal") return { u: l, v: s, w: p, flipU: !along(l, 0), flipV: along(s, 2) };
  return { u: p, v: s, w: l, flipU: !along(p, 1), flipV: along(s, 2) };
}

/** Fills `pixels` (RGBA) with slice `k` in grey, windowed. */
export function drawSlice(volume: Volume, axes: SliceAxes, k: number, window: [number, number], pixels: Uint8ClampedArray): void {
  const { u, v, w, flipU, flipV } = axes;
  const strides: Vec3 = [1, volume.size[0], volume.size[0] * volume.size[1]];
  const nu = volume.size[u];
  const nv = volume.size[v];
  const low = (window[0] - volume.low) / volume.step;
  const scale = 255 / Math.max(1e-9, (window[1] - window[0]) / volume.step);
  const rgba = new Uint32Array(pixels.buffer, pixels.byteOffset, nu * nv);
  const step = flipU ? -strides[u] : strides[u];
  for (let row = 0; row < nv; ++row) {
    let at = k * strides[w] + (flipV ? nv - 1 - row : row) * strides[v] + (flipU ? (nu - 1) * strides[u] : 0);
    for (let i = row * nu; i < (row + 1) * nu; ++i, at += step) {
      const grey = Math.min(255, Math.max(0, ((volume.voxels[at] ?? 0) - low) * scale)) | 0;
      rgba[i] = 0xff000000 | (grey << 16) | (grey << 8) | grey;
    }
  }
}
