import type { FieldChoice } from "../app/field_choice";
import { TimeBar } from "../app/time_bar";
import { Curves } from "../charts/curves";
import { other } from "../core/api";
import { column, type Case, type Table } from "../core/case";
import { byId, make } from "../core/dom";
import { shortNumber } from "../core/numbers";
import { ExportPanel } from "../export/export_panel";
import { FrameStore } from "../scene/frame_store";
import { HipModel } from "../scene/hip_model";
import { Viewer } from "../scene/viewer";
import { LinkedCameras } from "./linked_cameras";
import { frameAt, pairOf, spread } from "./shares";

const kFigures: [column: string, label: string, unit: string][] = [
  ["flexion_deg", "flexion", "°"],
  ["adduction_deg", "adduction", "°"],
  ["internal_rotation_deg", "internal rotation", "°"],
  ["peak_pressure_p99_MPa", "peak pressure", "MPa"],
  ["mean_pressure_MPa", "mean pressure", "MPa"],
  ["contact_area_mm2", "contact area", "mm²"],
];
const kCurves: [column: string, title: string][] = [
  ["flexion_deg", "Flexion [°]"],
  ["peak_pressure_p99_MPa", "Peak pressure [MPa]"],
  ["mean_pressure_MPa", "Mean pressure [MPa]"],
  ["contact_area_mm2", "Contact area [mm²]"],
];

/** The second result, as far as it is looked at. */
interface Second {
  info: Case;
  viewer: Viewer;
  hip: HipModel;
  frames: FrameStore;
}

/** Two results side by side: one camera, one colour range, one slider over the share of the movement. */
export class ComparePage {
  readonly panel = make("div");
  readonly side = make("div");
  time: TimeBar | null = null;
  second: Second | null = null;
  private share = 0;
  private readonly rows = make("tbody");
  private readonly curves: Curves;
  private readonly names: [string, string];

  constructor(
    private readonly info: Case,
    private readonly viewer: Viewer,
    private readonly hip: HipModel,
    private readonly frames: FrameStore,
    private readonly colours: FieldChoice,
  ) {
    this.names = ["A", "B"];
    this.curves = new Curves((step) => void this.show(step));
    const head = make("tr", {}, ...["", "A", "B", "B − A"].map((text) => make("th", { scope: "col" }, text)));
    this.side.append(make("h2", {}, "A against B"), make("table", {}, make("caption", {}, "At this share of the movement"), make("thead", {}, head), this.rows), this.curves.element);
  }

  get steps(): number {
    return Math.max(this.frames.count, this.second?.frames.count ?? 0);
  }

  /** Reads the second result when first looked at. */
  async open(onLoaded: (second: Viewer) => void): Promise<void> {
    if (!this.second) await this.load(onLoaded);
    this.time = this.makeTimeBar();
    await this.show(Math.round(this.share * Math.max(1, this.steps - 1)));
  }

  themeChanged(): void {
    this.curves.build();
  }

  async show(step: number): Promise<void> {
    const { second } = this;
    if (!second || this.steps === 0) return;
    this.share = this.steps > 1 ? step / (this.steps - 1) : 0;
    const wanted = this.share;
    this.time?.set(step);
    this.curves.setFrame(step);
    const at: [number, number] = [frameAt(wanted, this.frames.count), frameAt(wanted, second.frames.count)];
    const [a, b] = await Promise.all([this.frames.get(at[0]), second.frames.get(at[1])]);
    if (wanted !== this.share) return; // the slider has gone on meanwhile
    this.hip.apply(a);
    second.hip.apply(b);
    this.colours.apply();
    this.tell(at);
    byId("time").dataset["frame"] = `${at[0]} ${at[1]}`;
  }

  private async load(onLoaded: (second: Viewer) => void): Promise<void> {
    const info = await other.case();
    const viewer = new Viewer(byId<HTMLCanvasElement>("scene2"));
    const hip = new HipModel(viewer, other);
    const frames = new FrameStore(info.summary?.rows.length ?? 0, (index) => other.frame(index));
    await hip.load(info);
    this.second = { info, viewer, hip, frames };
    this.colours.second = { hip, frames: () => frames.loaded() };
    byId("name1").textContent = `A: ${this.info.name}`;
    byId("name2").textContent = `B: ${info.name === this.info.name ? (this.info.other ?? info.name) : info.name}`;
    new LinkedCameras(this.viewer, this.info.clock?.centre ?? [0, 0, 0], viewer, info.clock?.centre ?? [0, 0, 0]);
    onLoaded(viewer);
    this.startCurves(info);
    this.panel.append(this.exports(viewer).element);
    // the range is that of all frames of both
    await Promise.all([this.frames.fetchAhead(() => undefined), frames.fetchAhead(() => undefined)]);
    document.body.dataset["bothLoaded"] = "yes";
  }

  private makeTimeBar(): TimeBar {
    return new TimeBar(this.steps, (step) => void this.show(step), (step) => `${Math.round((100 * step) / Math.max(1, this.steps - 1))} % of the movement`);
  }

  private exports(second: Viewer): ExportPanel {
    return new ExportPanel({
      name: `${this.info.name}_compared`,
      viewers: () => [this.viewer, second],
      scale: () => this.colours.scale,
      caption: () => `${byId("name1").textContent}   |   ${byId("name2").textContent}   |   ${Math.round(100 * this.share)} % of the movement`,
      frames: this.steps,
      current: () => Math.round(this.share * (this.steps - 1)),
      show: (step) => this.show(step),
      tables: [{ label: "CSV of the curves", file: `${this.info.name}_compared.csv`, table: this.table() }],
    });
  }

  private of(info: Case, name: string): number[] {
    return info.summary ? column(info.summary, name) : [];
  }

  private startCurves(info: Case): void {
    const n = this.steps;
    const percent = Array.from({ length: n }, (_, i) => (100 * i) / Math.max(1, n - 1));
    const plots = kCurves.map(([name, title]) => ({
      title,
      curves: [this.info, info].map((of, i) => ({ label: this.names[i] ?? "", values: spread(this.of(of, name), n) })),
    }));
    this.curves.show(percent, plots, percent.map(() => false), "Over the share of the movement [%].");
  }

  private table(): Table {
    const n = this.steps;
    const second = this.second;
    const columns = ["percent", ...kCurves.flatMap(([name]) => [`A_${name}`, `B_${name}`])];
    const values = kCurves.flatMap(([name]) => [spread(this.of(this.info, name), n), spread(second ? this.of(second.info, name) : [], n)]);
    return { columns, rows: Array.from({ length: n }, (_, i) => [(100 * i) / Math.max(1, n - 1), ...values.map((v) => v[i] ?? NaN)]) };
  }

  private tell([a, b]: [number, number]): void {
    const second = this.second;
    if (!second) return;
    const pairs = kFigures.map(([name, label, unit]) => pairOf(label, unit, this.of(this.info, name)[a] ?? NaN, this.of(second.info, name)[b] ?? NaN));
    this.rows.replaceChildren(
      ...pairs.map(({ label, unit, first, second: last, change }) =>
        make("tr", {}, make("th", { scope: "row" }, `${label} [${unit}]`), ...[first, last, change].map((value) => make("td", {}, shortNumber(value)))),
      ),
    );
  }
}
