/** Two movements of different lengths, side by side: both are looked at by share of the movement. */

/** The frame nearest to a share of the movement. */
export function frameAt(share: number, count: number): number {
  return Math.round(Math.min(1, Math.max(0, share)) * Math.max(0, count - 1));
}

/** Values given at evenly spread frames, at n others, straight between them; NaN beside a NaN. */
export function spread(values: number[], n: number): number[] {
  return Array.from({ length: n }, (_, i) => {
    const at = n > 1 ? (i / (n - 1)) * (values.length - 1) : 0;
    const low = Math.floor(at + 1e-9);
    const s = at - low;
    const a = values[low] ?? NaN;
    return s < 1e-9 ? a : a + s * ((values[low + 1] ?? NaN) - a);
  });
}

export interface Pair {
  label: string;
  unit: string;
  first: number;
  second: number;
  change: number; // of the second against the first
}
export function pairOf(label: string, unit: string, first: number, second: number): Pair {
  return { label, unit, first, second, change: second - first };
}
