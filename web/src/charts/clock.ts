import type { Clock, Vec3 } from "../core/case";
import { dot, length, minus } from "../core/dots";

/** Hour in [0, 12) of a place about the socket's axis; 0 is twelve o'clock. As ClockFace::hour. */
export function hourOf(clock: Clock, place: Vec3): number {
  const d = minus(place, clock.centre);
  const turn = Math.atan2(dot(d, clock.three), dot(d, clock.twelve)) / (2 * Math.PI);
  return 12 * (turn < 0 ? turn + 1 : turn);
}

/** Sector 0..11 centred on its hour. */
export function sectorOf(clock: Clock, place: Vec3): number {
  return Math.round(hourOf(clock, place)) % 12;
}

/**
 * A place on the flattened socket, in units of a right angle from its pole: x towards three, y towards twelve.
 * Angles from the pole are kept (azimuthal equidistant), so that areas near the rim are not squeezed.
 */
export function flattened(clock: Clock, place: Vec3): [x: number, y: number] {
  const d = minus(place, clock.centre);
  // the socket's cartilage lies opposite the axis, which points out of it
  const angle = Math.acos(Math.min(1, Math.max(-1, -dot(d, clock.axis) / Math.max(1e-9, length(d))))) / (Math.PI / 2);
  const x = dot(d, clock.three);
  const y = dot(d, clock.twelve);
  const r = Math.max(1e-9, Math.hypot(x, y));
  return [(angle * x) / r, (angle * y) / r];
}

export interface SectorMean {
  count: number;
  mean: number;
  high: number;
}

/** Plain means of vertex values by sector; NaN values are left out. */
export function sectorMeans(sectors: Uint8Array, vertices: Iterable<number>, values: Float32Array): SectorMean[] {
  const result: SectorMean[] = Array.from({ length: 12 }, () => ({ count: 0, mean: 0, high: -Infinity }));
  for (const v of vertices) {
    const value = values[v] ?? NaN;
    const sector = result[sectors[v] ?? 0];
    if (!sector || Number.isNaN(value)) continue;
    sector.count += 1;
    sector.mean += value;
    sector.high = Math.max(sector.high, value);
  }
  for (const sector of result) {
    sector.mean = sector.count > 0 ? sector.mean / sector.count : NaN;
    if (sector.count === 0) sector.high = NaN;
  }
  return result;
}
