import { api } from "../core/api";
import { button, labelled, make, range, say } from "../core/dom";
import { shortNumber } from "../core/numbers";
import type { ToWorker } from "../live/connection";
import type { Answer, Pose } from "../live/live_client";
import { hitOf, hourText, nearText, type NearPlace } from "../live/near_places";
import { Recorder } from "../live/recorder";
import type { HipModel } from "../scene/hip_model";
import type { Viewer } from "../scene/viewer";
import type { FieldChoice } from "./field_choice";
import type { Probe } from "./probe";

const kAxes: { key: keyof Pose; label: string; min: number; max: number }[] = [
  { key: "flexion_deg", label: "Flexion", min: -30, max: 130 },
  { key: "adduction_deg", label: "Adduction", min: -50, max: 40 },
  { key: "internal_rotation_deg", label: "Internal rotation", min: -50, max: 50 },
];
const kRest: Pose = { flexion_deg: 0, adduction_deg: 0, internal_rotation_deg: 0 };
const kDegreesPerPixel = 0.25;
const kTellEvery = 150; // ms: nobody reads numbers faster

type Row = [name: string, value: number | string, unit: string];
const near = (answer: Answer, what: "bone" | "labrum"): NearPlace | null => (answer.bundle.meta[what] as NearPlace | null | undefined) ?? null;

/** The live examination: the leg led by sliders or the mouse, the real solver answering. */
export class ExamPage {
  readonly panel = make("div");
  readonly side = make("div");
  private field = "";
  private waiting: Answer | null = null; // to be drawn
  private wanted: Pose = { ...kRest };
  private readonly sliders = new Map<keyof Pose, { input: HTMLInputElement; shown: HTMLOutputElement }>();
  private readonly figures = make("tbody");
  private readonly times = make("tbody");
  private readonly verdict = make("p", { class: "note", role: "status" });
  private readonly exactness = make("p", { class: "note" });
  private readonly recorder = new Recorder();
  private readonly recordState = make("p", { class: "note" });
  private replay: ReturnType<typeof setInterval> | undefined;
  private arrivals: number[] = [];
  private drawMs = 0;
  private lastTimes: Partial<Record<string, number>> = {};
  private dragging = false;
  private told = 0;
  answers = 0;

  constructor(
    private readonly viewer: Viewer,
    private readonly hip: HipModel,
    private readonly colours: FieldChoice,
    private readonly probe: Probe,
    start: Pose | undefined, // at which the hip was imaged: where the server's hip begins
    private readonly ask: (message: ToWorker) => void,
    private readonly hasLabrum: boolean,
  ) {
    this.wanted = { ...(start ?? kRest) };
    this.panel.append(make("h2", {}, "Lead the leg"), ...kAxes.map((axis) => this.slider(axis)), this.buttons(), this.dragSwitch(), ...this.recording());
    const table = (caption: string, body: HTMLElement): HTMLElement => make("table", {}, make("caption", {}, caption), body);
    this.side.append(make("h2", {}, "Live"), this.verdict, table("At this pose", this.figures), this.exactness, table("Times [ms]", this.times));
    this.verdict.textContent = "Move a slider: the first answer seats the head and takes longer.";
    this.listenToDrags();
  }

  enter(): void {
    this.viewer.onDrawn = (ms) => (this.drawMs = ms);
    this.askForField();
    this.leadTo(this.wanted);
  }
  leave(): void {
    this.viewer.onDrawn = null;
    this.stopReplay();
    this.viewer.showMarker(null, "hit");
    this.ask({ kind: "leave" });
  }

  /** Another field may be looked at: the next answers carry it. */
  fieldChanged(): void {
    if (this.askForField()) this.ask({ kind: "again" });
  }

  private askForField(): boolean {
    const field = this.colours.field ?? "contact_pressure";
    const changed = field !== this.field;
    this.field = field;
    if (changed) this.ask({ kind: "field", field });
    return changed;
  }

  /** Drawn when the page comes to it; of several that have come meanwhile the last. */
  receive(answer: Answer): void {
    this.answers += 1;
    this.arrivals = [...this.arrivals, answer.arrivedAt].slice(-20);
    if (answer.type === "step" && answer.status === "converged") this.recorder.add(answer.pose, answer.arrivedAt / 1000);
    if (!this.waiting) setTimeout(() => this.showWaiting());
    this.waiting = answer;
  }
  private showWaiting(): void {
    const answer = this.waiting;
    this.waiting = null;
    if (answer) this.show(answer);
  }

  fail(number: number, text: string): void {
    this.ask({ kind: "fail", number });
    this.verdict.textContent = text;
    say(text, "error");
  }

  private leadTo(pose: Pose): void {
    this.wanted = { ...pose };
    for (const { key, min, max } of kAxes) {
      this.wanted[key] = Math.min(max, Math.max(min, this.wanted[key]));
      const slider = this.sliders.get(key);
      if (!slider) continue;
      slider.input.value = String(this.wanted[key]);
      slider.shown.textContent = `${this.wanted[key].toFixed(1)}°`;
    }
    this.ask({ kind: "move", pose: this.wanted });
  }

  private slider({ key, label, min, max }: (typeof kAxes)[number]): HTMLElement {
    const shown = make("output", {}, "0.0°");
    const input = range(min, max, 0.5, 0, (value) => {
      this.stopReplay();
      this.leadTo({ ...this.wanted, [key]: value });
    });
    input.dataset["axis"] = key;
    this.sliders.set(key, { input, shown });
    const row = labelled(label, input);
    row.insertBefore(shown, input);
    return row;
  }

  private buttons(): HTMLElement {
    const to = (text: string, pose: Partial<Pose>): HTMLButtonElement =>
      button(text, () => {
        this.stopReplay();
        this.leadTo({ ...kRest, ...pose });
      });
    return make(
      "div",
      { class: "buttons" },
      to("Rest", {}),
      to("Flexion 90", { flexion_deg: 90 }),
      to("FADIR", { flexion_deg: 90, adduction_deg: 10, internal_rotation_deg: 20 }),
      to("FABER", { flexion_deg: 60, adduction_deg: -30, internal_rotation_deg: -30 }),
    );
  }

  private dragSwitch(): HTMLElement {
    const toggle = button("Mouse leads the leg", () => {
      this.dragging = !this.dragging;
      toggle.setAttribute("aria-pressed", String(this.dragging));
      this.viewer.controls.enabled = !this.dragging;
    }, { "aria-pressed": "false" });
    const note = make("p", { class: "note" }, "Up and down: flexion. Across: rotation; with Shift: adduction. Else the mouse turns the view.");
    return make("div", {}, toggle, note);
  }

  private listenToDrags(): void {
    let last: [number, number] | null = null;
    const canvas = this.viewer.canvas;
    canvas.addEventListener("pointerdown", (event) => {
      if (!this.dragging || event.button !== 0) return;
      last = [event.clientX, event.clientY];
      canvas.setPointerCapture(event.pointerId);
      this.stopReplay();
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!last) return;
      const across = (event.clientX - last[0]) * kDegreesPerPixel;
      const up = (last[1] - event.clientY) * kDegreesPerPixel;
      last = [event.clientX, event.clientY];
      const key = event.shiftKey ? "adduction_deg" : "internal_rotation_deg";
      this.leadTo({ ...this.wanted, flexion_deg: this.wanted.flexion_deg + up, [key]: this.wanted[key] + across });
    });
    canvas.addEventListener("pointerup", () => (last = null));
  }

  private recording(): HTMLElement[] {
    const record = button("Record", () => {
      if (this.recorder.recording) this.recorder.stop();
      else this.recorder.begin();
      record.textContent = this.recorder.recording ? "Stop" : "Record";
      record.setAttribute("aria-pressed", String(this.recorder.recording));
      this.describeRecord();
    }, { "aria-pressed": "false" });
    const name = make("input", { type: "text", value: "examination", "aria-label": "Name of the movement", size: 14 });
    const save = button("Save movement", () => {
      if (this.recorder.length < 2) return say("Nothing is recorded yet.", "error");
      api
        .saveMovement(this.recorder.movement(name.value))
        .then(({ file }) => say(`Saved as ${file} in the subject's folder.`))
        .catch((error: Error) => say(error.message, "error"));
    });
    return [
      make("h2", {}, "Record"),
      make("div", { class: "buttons" }, record, button("Replay", () => this.startReplay())),
      make("div", { class: "buttons" }, name, save),
      this.recordState,
    ];
  }

  private describeRecord(): void {
    this.recordState.textContent = `${this.recorder.length} poses, ${this.recorder.duration.toFixed(1)} s`;
  }

  private startReplay(): void {
    this.stopReplay();
    if (this.recorder.length < 2) return say("Nothing is recorded yet.", "error");
    const start = performance.now();
    this.replay = setInterval(() => {
      const time = (performance.now() - start) / 1000;
      const pose = this.recorder.at(time);
      if (pose) this.leadTo(pose);
      if (time > this.recorder.duration) this.stopReplay();
    }, 50);
  }
  private stopReplay(): void {
    clearInterval(this.replay);
    this.replay = undefined;
  }

  private show(answer: Answer): void {
    const start = performance.now();
    const waiting = Math.max(0, performance.timeOrigin + start - answer.arrivedAt);
    if (answer.status === "converged") {
      this.hip.apply(answer.bundle);
      this.colours.apply();
      this.probe.refresh();
    }
    this.viewer.showMarker(hitOf(near(answer, "bone"), near(answer, "labrum"))?.place ?? null, "hit");
    if (this.recorder.recording) this.describeRecord();
    const javascript = performance.now() - start;
    this.noteTimes(answer, javascript, waiting);
    const last = answer.type === "settled" || answer.arrived || answer.status !== "converged";
    if (!last && start - this.told < kTellEvery) return;
    this.told = start;
    this.tell(answer);
  }

  private noteTimes(answer: Answer, javascript: number, waiting: number): void {
    const at = (key: string): number => Number(answer.bundle.meta[key] ?? NaN);
    const [solver, packing] = [at("solver_ms"), at("packing_ms")];
    const transfer = Math.max(0, answer.roundTripMs - solver - packing);
    const span = (this.arrivals.at(-1) ?? 0) - (this.arrivals[0] ?? 0);
    const rate = this.arrivals.length > 1 ? (1000 * (this.arrivals.length - 1)) / span : NaN;
    this.lastTimes = { solver, packing, transfer, waiting, javascript, drawing: this.drawMs, rate, tets: at("tets"), bytes: answer.bundle.bytes, answers: this.answers };
    this.times.dataset["times"] = JSON.stringify(this.lastTimes);
  }

  private tell(answer: Answer): void {
    const meta = answer.bundle.meta as Record<string, number | null>;
    const number = (key: string): number => meta[key] ?? NaN;
    const { flexion_deg, adduction_deg, internal_rotation_deg } = answer.pose;
    const [bone, labrum] = [near(answer, "bone"), near(answer, "labrum")];
    const reached = `flexion ${flexion_deg.toFixed(1)}°, adduction ${adduction_deg.toFixed(1)}°, internal rotation ${internal_rotation_deg.toFixed(1)}°`;
    const verdicts = {
      converged: `Equilibrium at ${reached}.`,
      failed: `No equilibrium found on the way; the leg stays at ${reached}. ${answer.reason}`,
      beyond_bony_limit: `The bones meet${bone ? ` at ${hourText(bone.hour)} o'clock` : ""}: the leg stays at ${reached}. ${answer.reason}`,
    };
    const onLabrum = labrum && labrum.clearance_mm < 0 ? ` The femur is ${shortNumber(-labrum.clearance_mm)} mm into the labrum at ${hourText(labrum.hour)} o'clock.` : "";
    this.verdict.textContent = verdicts[answer.status] + onLabrum;
    this.verdict.classList.toggle("bad", answer.status !== "converged");
    this.verdict.dataset["status"] = answer.status;
    this.verdict.dataset["type"] = answer.type;
    if (answer.status === "converged") {
      this.rows(this.figures, [
        ["Peak pressure (99th percentile)", number("peak_pressure_p99_MPa"), "MPa"],
        ["Mean pressure", number("mean_pressure_MPa"), "MPa"],
        ["Contact area", number("contact_area_mm2"), "mm²"],
        ["Femur to hip bone", nearText(bone), ""],
        ...(this.hasLabrum ? [["Femur to labrum", nearText(labrum), ""] as Row] : []),
        ["Overlap left", number("penetration_mm"), "mm"],
        ["Force left, of the joint force", 100 * number("residual"), "%"],
      ]);
    }
    if (answer.type === "settled" && answer.status === "converged") this.compare(number);
    else if (answer.type === "step") this.exactness.textContent = "Led by hand, to a loose tolerance; at rest it is compared with the full solution.";
    const { solver = NaN, packing = NaN, transfer = NaN, waiting = NaN, javascript = NaN, rate = NaN, tets = NaN, bytes = NaN } = this.lastTimes;
    this.rows(this.times, [
      ["Solver", solver, ""],
      ["Fields and packing", packing, ""],
      ["Transfer", transfer, ""],
      ["Waiting for the page", waiting, ""],
      ["JavaScript", javascript, ""],
      [this.viewer.software ? "Drawing (no graphics card)" : "Drawing", this.drawMs, ""],
      ["Updates a second", rate, ""],
      ["Kilobytes an answer", bytes / 1000, ""],
      ["Tetrahedra", tets, ""],
    ]);
  }

  private compare(number: (key: string) => number): void {
    const live = number("live_peak_pressure_p99_MPa");
    const full = number("peak_pressure_p99_MPa");
    this.exactness.textContent =
      `Against the full solution here: peak pressure ${shortNumber(live)} by hand, ${shortNumber(full)} MPa settled ` +
      `(${shortNumber((100 * Math.abs(live - full)) / full)} %); largest move of a node ${shortNumber(number("largest_move_mm"))} mm.`;
    this.exactness.dataset["settled"] = "yes";
  }

  private rows(body: HTMLElement, rows: Row[]): void {
    body.replaceChildren(
      ...rows.map(([name, value, unit]) => make("tr", {}, make("th", { scope: "row" }, name), make("td", {}, typeof value === "string" ? value : `${shortNumber(value)} ${unit}`))),
    );
  }
}
