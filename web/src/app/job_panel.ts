import type { Case } from "../core/case";
import { button, labelled, make, say, select } from "../core/dom";

export interface Job {
  state: "none" | "running" | "done" | "failed" | "cancelled";
  job?: string;
  stage?: string;
  share?: number;
  seconds?: number;
  seconds_left?: number;
  text?: string;
  warnings?: string[];
}

/** "1 min 20 s" for people. */
export function duration(seconds: number): string {
  const whole = Math.round(seconds);
  return whole < 60 ? `${whole} s` : `${Math.floor(whole / 60)} min ${whole % 60} s`;
}

/** Runs segmentation or the whole chain, and shows how far it is. */
export class JobPanel {
  readonly element = make("section", { "aria-label": "Runs" });
  onDone: (() => void) | null = null;
  private readonly bar = make("progress", { max: 1, value: 0, "aria-label": "Progress" });
  private readonly text = make("p", { class: "note", role: "status" });
  private readonly warnings = make("ul");
  private readonly buttons: HTMLButtonElement[] = [];
  private readonly cancel: HTMLButtonElement;
  private running = false;

  constructor(info: Case, send: (message: Record<string, unknown>) => boolean) {
    let side = info.side ?? "right";
    const start = (job: string): void => {
      if (!send({ type: "job_start", job, side })) say("The connection is lost.", "error");
    };
    this.buttons.push(button("Segment the hip", () => start("segment"), { "data-testid": "segment" }));
    if (info.can_run) this.buttons.push(button("Run the whole chain", () => start("run")));
    this.cancel = button("Stop", () => send({ type: "job_cancel" }), { disabled: true });
    this.element.append(make("h2", {}, "Run"));
    if (!info.side) {
      const choice = select([["right", "right"], ["left", "left"]], (value) => (side = value as "left" | "right"));
      choice.dataset["testid"] = "job-side";
      this.element.append(labelled("Side of the hip", choice));
    }
    this.element.append(make("div", { class: "buttons" }, ...this.buttons, this.cancel), this.bar, this.text, this.warnings);
    this.show({ state: "none" });
  }

  show(job: Job): void {
    const running = job.state === "running";
    for (const b of this.buttons) b.disabled = running;
    this.cancel.disabled = !running;
    this.bar.value = job.share ?? 0;
    this.element.dataset["state"] = job.state;
    const left = job.seconds_left === undefined ? "" : `, about ${duration(job.seconds_left)} left`;
    const texts: Record<Job["state"], string> = {
      none: "Nothing is running. Landmarks help the segmentation find the hip; six that span both bones are enough.",
      running: `${job.job ?? ""}: ${job.stage ?? ""} ${Math.round(100 * (job.share ?? 0))} %, ${duration(job.seconds ?? 0)} so far${left}`,
      done: `${job.job ?? ""}: done in ${duration(job.seconds ?? 0)}.`,
      failed: `${job.job ?? ""} failed: ${job.text ?? ""}`,
      cancelled: "Stopped. Finished stages are kept.",
    };
    this.text.textContent = texts[job.state];
    this.text.classList.toggle("bad", job.state === "failed");
    this.warnings.replaceChildren(...(job.warnings ?? []).map((text) => make("li", { class: "note" }, text)));
    if (this.running && job.state === "done") this.onDone?.();
    this.running = running;
  }
}
