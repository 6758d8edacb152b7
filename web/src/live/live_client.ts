import type { Bundle } from "../core/bundle";

export interface Pose {
  flexion_deg: number;
  adduction_deg: number;
  internal_rotation_deg: number;
}

export interface Answer {
  type: "step" | "settled";
  number: number;
  status: "converged" | "failed" | "beyond_bony_limit";
  arrived: boolean;
  reason: string;
  pose: Pose;
  roundTripMs: number;
  arrivedAt: number; // ms since 1970
  bundle: Bundle;
}

export const samePose = (a: Pose, b: Pose): boolean =>
  Math.abs(a.flexion_deg - b.flexion_deg) < 1e-6 &&
  Math.abs(a.adduction_deg - b.adduction_deg) < 1e-6 &&
  Math.abs(a.internal_rotation_deg - b.internal_rotation_deg) < 1e-6;

const kSettleAfter = 400; // ms of rest before the exact state is asked for

/**
 * Leads the server's hip: one question at a time is under way; its answer asks for the next step before it is
 * drawn, so that the solver works while the browser draws. After a rest the exact state is asked for.
 */
export class LiveClient {
  /** The field that answers to steps carry beside the contact pressure. */
  field = "contact_pressure";
  private wanted: Pose | null = null;
  private asked: { number: number; exact: boolean; at: number; pose: Pose | null } | null = null;
  private number = 0;
  private timer: ReturnType<typeof setTimeout> | undefined;

  constructor(
    private readonly send: (message: Record<string, unknown>) => boolean,
    private readonly onAnswer: (answer: Answer) => void,
    private readonly now: () => number = () => performance.now(),
  ) {}

  get busy(): boolean {
    return this.asked !== null;
  }

  moveTo(pose: Pose): void {
    this.wanted = { ...pose };
    clearTimeout(this.timer);
    // a settling is given up for a new pose; a step is left to finish
    if (!this.asked || this.asked.exact) this.ask(false);
  }

  /** The same pose again, for another field. */
  again(): void {
    if (this.wanted) this.moveTo(this.wanted);
  }

  /** A bundle that came over the socket. @returns false for one that is no longer waited for */
  receive(bundle: Bundle): boolean {
    const meta = bundle.meta as unknown as Omit<Answer, "pose" | "bundle" | "roundTripMs"> & Pose;
    const question = this.asked;
    if (!question || meta.number !== question.number) return false;
    this.asked = null;
    const moved = this.wanted !== null && (question.pose === null || !samePose(this.wanted, question.pose));
    const goOn = meta.type === "step" && (moved || (meta.status === "converged" && !meta.arrived));
    if (goOn) this.ask(false);
    else if (meta.type === "step" && meta.status === "converged") this.settleSoon();
    this.onAnswer({
      ...meta,
      pose: { flexion_deg: meta.flexion_deg, adduction_deg: meta.adduction_deg, internal_rotation_deg: meta.internal_rotation_deg },
      roundTripMs: this.now() - question.at,
      arrivedAt: performance.timeOrigin + performance.now(),
      bundle,
    });
    return true;
  }

  /** The server gave up the question with this number. */
  fail(number: number): void {
    if (this.asked?.number === number) this.asked = null;
  }

  /** The connection came back: a hip of the server's is new, so the pose is asked for again. */
  reconnect(): void {
    this.asked = null;
    if (this.wanted) this.ask(false);
  }

  leave(): void {
    clearTimeout(this.timer);
    this.asked = null;
    this.wanted = null;
    this.send({ type: "live_leave" });
  }

  private settleSoon(): void {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => {
      if (!this.asked) this.ask(true);
    }, kSettleAfter);
  }

  private ask(exact: boolean): void {
    if (!exact && !this.wanted) return;
    const number = ++this.number;
    const message = exact ? { type: "settle", number } : { type: "pose", number, field: this.field, ...this.wanted };
    if (!this.send(message)) return;
    this.asked = { number, exact, at: this.now(), pose: exact ? null : { ...(this.wanted as Pose) } };
  }
}
