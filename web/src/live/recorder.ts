import type { Movement } from "../core/api";
import type { Pose } from "./live_client";

/** A movement led by hand: poses with their times from the first. */
export class Recorder {
  private start = 0;
  private rows: { time: number; pose: Pose }[] = [];
  recording = false;

  get length(): number {
    return this.rows.length;
  }
  get duration(): number {
    return this.rows.at(-1)?.time ?? 0;
  }

  begin(): void {
    this.rows = [];
    this.recording = true;
  }
  stop(): void {
    this.recording = false;
  }

  /** @param at seconds of any clock that goes forward */
  add(pose: Pose, at: number): void {
    if (!this.recording) return;
    if (this.rows.length === 0) this.start = at;
    const time = at - this.start;
    if (this.rows.length > 0 && time <= this.duration) return;
    this.rows.push({ time, pose: { ...pose } });
  }

  /** Pose at a time, straight between the recorded ones. */
  at(time: number): Pose | null {
    const next = this.rows.findIndex((row) => row.time >= time);
    const b = this.rows[next === -1 ? this.rows.length - 1 : next];
    const a = this.rows[next === -1 ? this.rows.length - 1 : Math.max(0, next - 1)];
    if (!a || !b) return null;
    const s = b.time > a.time ? Math.min(1, (time - a.time) / (b.time - a.time)) : 1;
    const mix = (key: keyof Pose): number => a.pose[key] + s * (b.pose[key] - a.pose[key]);
    return { flexion_deg: mix("flexion_deg"), adduction_deg: mix("adduction_deg"), internal_rotation_deg: mix("internal_rotation_deg") };
  }

  movement(name: string): Movement {
    const all = (key: keyof Pose): number[] => this.rows.map((row) => Number(row.pose[key].toFixed(4)));
    return {
      name,
      time_s: this.rows.map((row) => Number(row.time.toFixed(4))),
      flexion_deg: all("flexion_deg"),
      adduction_deg: all("adduction_deg"),
      internal_rotation_deg: all("internal_rotation_deg"),
    };
  }
}
