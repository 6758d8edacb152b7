import { percentile } from "../core/numbers";
import type { MapName } from "./maps";

export interface Scale {
  map: MapName;
  low: number;
  high: number;
  label: string; // with the unit
}

export const share = (scale: Scale, value: number): number => (value - scale.low) / (scale.high - scale.low);

/**
 * A range for values of any number of frames: from the lowest of values that are never negative (else the 1st
 * percentile) to the 99th percentile, so that one hot vertex does not flatten the picture.
 */
export function rangeOf(arrays: Float32Array[]): [low: number, high: number] {
  const some: number[] = [];
  for (const values of arrays) {
    // thin out: percentiles of a few thousand values are enough for a range
    const step = Math.max(1, Math.floor(values.length / 4000));
    for (let i = 0; i < values.length; i += step) some.push(values[i] ?? NaN);
  }
  const lowest = percentile(some, 0);
  // exact zeros are no contact: they say nothing of how high a pressure is
  const high = percentile(lowest === 0 ? some.filter((value) => value !== 0) : some, 0.99);
  // a range that begins next to nothing begins at nothing
  const low = lowest < 0 ? percentile(some, 0.01) : lowest < 0.02 * high ? 0 : lowest;
  if (!Number.isFinite(low)) return [0, 1];
  return high > low ? [low, high] : [low, low + Math.max(1e-6, Math.abs(low) * 0.01)];
}
