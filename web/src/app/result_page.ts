import { ClockMap } from "../charts/clock_map";
import { bandChoices, intervalBand, normalBand, type Band, type BandKind } from "../charts/bands";
import { Curves, type Curve } from "../charts/curves";
import { floats, triangles } from "../core/bundle";
import { column, textColumn, type Case, type Table } from "../core/case";
import { button, byId, labelled, make, select } from "../core/dom";
import { firstContacts, firstContactText, type FirstContact } from "../live/near_places";
import { ExportPanel } from "../export/export_panel";
import type { FrameStore } from "../scene/frame_store";
import type { HipModel } from "../scene/hip_model";
import type { Viewer } from "../scene/viewer";
import type { FieldChoice } from "./field_choice";
import type { Probe } from "./probe";
import { TimeBar } from "./time_bar";

/** The finished movement: curves, clock face and time slider, all at one frame. */
export class ResultPage {
  readonly panel = make("div");
  readonly side = make("div");
  readonly time: TimeBar | null;
  lastFrameMs = 0;
  private frame = 0;
  private bands: BandKind = "none";
  private readonly curves: Curves;
  private readonly clock: ClockMap;
  private readonly bandSource = make("p", { class: "note", "data-testid": "band-source" });

  constructor(
    private readonly info: Case,
    private readonly viewer: Viewer,
    private readonly hip: HipModel,
    private readonly frames: FrameStore,
    private readonly colours: FieldChoice,
    private readonly probe: Probe,
  ) {
    this.curves = new Curves((frame) => void this.show(frame));
    this.clock = new ClockMap(info.side ?? "right");
    const summary = info.summary;
    this.time = summary ? new TimeBar(frames.count, (frame) => void this.show(frame), (frame) => this.frameText(summary, frame)) : null;
    this.panel.append(...this.contacts(), ...this.exports(), ...this.notes());
    if (summary) this.side.append(this.clock.element, this.bandChoice(summary), this.bandSource, this.curves.element);
    else this.side.append(make("p", {}, "No simulation yet: curves and maps appear here when the chain has run."));
    if (summary) this.startCurves(summary);
  }

  get currentFrame(): number {
    return this.frame;
  }

  async show(frame: number): Promise<void> {
    if (this.frames.count === 0) return;
    this.frame = Math.min(this.frames.count - 1, Math.max(0, frame));
    const wanted = this.frame;
    this.time?.set(wanted);
    this.curves.setFrame(wanted);
    const bundle = this.frames.peek(wanted) ?? (await this.frames.get(wanted));
    if (wanted !== this.frame) return; // the slider has gone on meanwhile
    const start = performance.now();
    this.hip.apply(bundle);
    this.refresh();
    this.viewer.showMarker(this.hitAt(wanted)?.place ?? null, "hit");
    this.lastFrameMs = performance.now() - start;
    byId("time").dataset["frame"] = String(wanted);
    byId("time").dataset["readyMs"] = this.lastFrameMs.toFixed(1);
  }

  /** Colours, clock face and probe again, at the same frame. */
  refresh(): void {
    this.colours.apply();
    const field = this.colours.field;
    this.clock.show(field ? this.hip.values("acetabular_cartilage", field) : null, this.colours.scale);
    this.probe.refresh();
  }

  themeChanged(): void {
    this.curves.build();
    this.refresh();
  }

  private frameText(summary: Table, frame: number): string {
    const at = (name: string): number => column(summary, name)[frame] ?? NaN;
    const angle = (name: string): string => `${at(name).toFixed(1)}°`;
    const status = textColumn(summary, "status")[frame] ?? "";
    const text = `Frame ${frame + 1} of ${summary.rows.length} · ${at("time_s").toFixed(2)} s · flexion ${angle("flexion_deg")}, adduction ${angle("adduction_deg")}, internal rotation ${angle("internal_rotation_deg")}`;
    return status === "converged" ? text : `${text} · ${status.replaceAll("_", " ")}: no result`;
  }

  /** The surfaces are there: the clock face can be laid out. */
  surfacesLoaded(): void {
    const body = this.hip.bodies.get("acetabular");
    const tags = body?.arrays.get("tags");
    if (!body || !this.info.clock || !(tags instanceof Uint8Array)) return;
    this.clock.setSurface(this.info.clock, floats(body, "positions"), triangles(body), tags);
  }

  /** What is drawn behind the joint angles. */
  private bandChoice(summary: Table): HTMLElement {
    const choices = bandChoices(this.info.movement, this.info.normal_curves, this.info.motion);
    this.bands = choices[0]?.[0] ?? "none";
    const choice = select(choices, (value) => {
      this.bands = value;
      this.startCurves(summary);
    });
    choice.dataset["testid"] = "bands";
    return labelled("Bands behind the angles", choice);
  }

  private bandOf(angle: string, time: number[]): Band | null {
    if (this.bands === "intervals") return intervalBand(this.info.motion, angle);
    const normal = this.info.normal_curves.find((curve) => curve.movement === this.bands && curve.angle === angle);
    return normal ? normalBand(normal, time) : null;
  }

  private describeBands(): void {
    const normal = this.info.normal_curves.find((curve) => curve.movement === this.bands);
    const own = this.bands === "intervals" ? "Shaded: 95 % intervals of this recording, by its markers." : "";
    this.bandSource.textContent = normal ? `Shaded: mean ± SD over the whole movement, taken for one cycle. ${normal.source}.` : own;
  }

  private startCurves(summary: Table): void {
    const time = column(summary, "time_s");
    const pick = (names: [column: string, label: string][]): Curve[] =>
      names.map(([name, label]) => {
        const band = this.bandOf(name, time);
        return { label, values: column(summary, name), ...(band ? { band } : {}) };
      });
    this.describeBands();
    const distances: [string, string][] = [["bone_clearance_mm", "from the hip bone"], ["labrum_clearance_mm", "from the labrum"]];
    this.curves.show(
      time,
      [
        ...([["flexion_deg", "flexion"], ["adduction_deg", "adduction"], ["internal_rotation_deg", "internal rotation"]] as const).map(([name, label]) => ({
          title: `${label.charAt(0).toUpperCase()}${label.slice(1)} [°]`,
          curves: pick([[name, label]]),
        })),
        { title: "Contact pressure [MPa]", curves: pick([["peak_pressure_p99_MPa", "peak (99th percentile)"], ["mean_pressure_MPa", "mean"]]) },
        { title: "Contact area [mm²]", curves: pick([["contact_area_mm2", "contact area"]]) },
        { title: "Femur's distance [mm]", curves: pick(distances.filter(([name]) => summary.columns.includes(name))) },
      ],
      textColumn(summary, "status").map((status) => status !== "converged"),
    );
  }

  /** Whether the femur overlaps the hip bone or the labrum at a frame. */
  private hits({ what }: FirstContact, frame: number): boolean {
    const summary = this.info.summary;
    if (!summary) return false;
    return (column(summary, what === "bones" ? "bone_clearance_mm" : "labrum_clearance_mm")[frame] ?? NaN) < 0;
  }
  private hitAt(frame: number): FirstContact | null {
    return firstContacts(this.info.stages ?? []).find((contact) => this.hits(contact, frame)) ?? null;
  }

  /** Where bones and labrum were hit, each with the way to its frame. */
  private contacts(): HTMLElement[] {
    const found = firstContacts(this.info.stages ?? []);
    if (found.length === 0) return [];
    const entry = (contact: FirstContact): HTMLElement => {
      const first = Array.from({ length: this.frames.count }, (_, frame) => frame).find((frame) => this.hits(contact, frame));
      const show = button("Show", () => void this.show(first ?? 0), { "aria-label": `Show the contact with the ${contact.what}` });
      return make("p", { class: "note", "data-contact": contact.what }, firstContactText(contact), " ", ...(first === undefined ? [] : [show]));
    };
    return [make("h2", {}, "Contacts"), ...found.map(entry)];
  }

  private exports(): HTMLElement[] {
    const table = this.info.summary;
    const panel = new ExportPanel({
      name: this.info.name,
      viewers: () => [this.viewer],
      scale: () => this.colours.scale,
      caption: () => (table ? `${this.info.name} · ${this.frameText(table, this.frame)}` : this.info.name),
      frames: this.frames.count,
      current: () => this.frame,
      show: (frame) => this.show(frame),
      tables: table ? [{ label: "CSV of the curves", file: `${this.info.name}_summary.csv`, table }] : [],
    });
    const parts: HTMLElement[] = [panel.element];
    if (this.info.report) parts.push(make("p", {}, make("a", { href: this.info.report, target: "_blank", rel: "noopener" }, "Report")));
    return parts;
  }

  private notes(): HTMLElement[] {
    const warnings = (this.info.stages ?? []).flatMap((stage) => stage.warnings.map((text) => `${stage.verb}: ${text}`));
    if (warnings.length === 0) return [];
    const list = make("ul", {}, ...warnings.map((text) => make("li", { class: "note" }, text)));
    return [make("details", {}, make("summary", {}, `${warnings.length} warnings of the run`), list)];
  }
}
