import type { Stage, Vec3 } from "../core/case";
import { shortNumber } from "../core/numbers";

/** Where the femur is nearest to the hip bone or the labrum. */
export interface NearPlace {
  clearance_mm: number; // negative: overlap
  place: Vec3;
  hour: number;
}

/** "1:30" for people; 0 is twelve. */
export function hourText(hour: number): string {
  const minutes = Math.round((((hour % 12) + 12) % 12) * 12) * 5; // to five minutes
  const whole = Math.floor(minutes / 60) % 12;
  return `${whole === 0 ? 12 : whole}:${String(minutes % 60).padStart(2, "0")}`;
}

/** What is told of the distance: "1.2 mm at 1:30 o'clock", or of an overlap. */
export function nearText(near: NearPlace | null): string {
  if (!near) return "more than 3 mm";
  const size = `${shortNumber(Math.abs(near.clearance_mm))} mm`;
  return near.clearance_mm < 0 ? `overlap of ${size} at ${hourText(near.hour)}` : `${size} at ${hourText(near.hour)}`;
}

/** Where something is hit now: bone before labrum. */
export function hitOf(bone: NearPlace | null, labrum: NearPlace | null): NearPlace | null {
  return [bone, labrum].find((near) => near !== null && near.clearance_mm < 0) ?? null;
}

/** First contact of a finished movement, as its joint stage tells it. */
export interface FirstContact {
  what: "bones" | "labrum";
  place: Vec3;
  hour: number;
  angles: [flexion: number, adduction: number, internal_rotation: number];
}

export function firstContacts(stages: Stage[]): FirstContact[] {
  const figures = stages.find((stage) => stage.verb === "joint")?.figures ?? {};
  const kinds: [FirstContact["what"], string][] = [["bones", "bony_limit"], ["labrum", "labrum_contact"]];
  return kinds.flatMap(([what, name]) => {
    const place = String(figures[`${name}_place_lps_mm`] ?? "").trim().split(/\s+/).map(Number);
    if (place.length !== 3 || place.some(Number.isNaN)) return [];
    const at = (key: string): number => Number(figures[`${name}_${key}`]);
    return [{ what, place: place as Vec3, hour: at("clock_hour"), angles: [at("flexion_deg"), at("adduction_deg"), at("internal_rotation_deg")] }];
  });
}

/** "The femur first meets the labrum at flexion 70.1°, … (1:30 o'clock)." */
export function firstContactText({ what, hour, angles: [flexion, adduction, rotation] }: FirstContact): string {
  const who = what === "bones" ? "The bones first meet" : "The femur first touches the labrum";
  return `${who} at flexion ${flexion.toFixed(1)}°, adduction ${adduction.toFixed(1)}°, internal rotation ${rotation.toFixed(1)}°, at ${hourText(hour)} o'clock.`;
}
