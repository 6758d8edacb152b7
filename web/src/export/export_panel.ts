import type { Scale } from "../colour/scale";
import type { Table } from "../core/case";
import { toCsv } from "../core/csv";
import { button, checkbox, download, labelled, make, say, select } from "../core/dom";
import type { Viewer } from "../scene/viewer";
import { animatedPng } from "./apng";
import { stillPicture } from "./still";

const kLargest = 8192; // pixels a side
const kFrameMs = 350;

/** What an export shows. */
export interface Exported {
  name: string; // of the files
  viewers(): Viewer[];
  scale(): Scale | null;
  caption(): string;
  frames: number;
  current(): number;
  show(frame: number): Promise<void>;
  tables: { label: string; file: string; table: Table }[];
}

/** Pictures of any size, an animation over the frames, and tables. */
export class ExportPanel {
  readonly element = make("section", { "aria-label": "Take away" });
  private readonly width = this.number("Width", 1280);
  private readonly height = this.number("Height", 800);
  private withBar = true;
  private busy = false;
  private readonly progress = make("p", { class: "note", role: "status" });

  constructor(private readonly what: Exported) {
    const sizes: [string, string][] = [["1280 800", "1280 × 800"], ["1920 1200", "1920 × 1200"], ["3840 2400", "3840 × 2400"]];
    const size = select(sizes, (value) => {
      const [width = "", height = ""] = value.split(" ");
      this.width.value = width;
      this.height.value = height;
    });
    const buttons = [button("PNG", () => void this.run(() => this.png()), { "data-testid": "png" })];
    if (what.frames > 1) buttons.push(button("Animation", () => void this.run(() => this.animation()), { "data-testid": "animation" }));
    for (const { label, file, table } of what.tables) buttons.push(button(label, () => download(file, toCsv(table))));
    this.element.append(
      make("h2", {}, "Take away"),
      labelled("Size of pictures", size),
      make("div", { class: "row pair" }, this.width, this.height),
      checkbox("With colour bar", true, (on) => (this.withBar = on)),
      make("div", { class: "buttons" }, ...buttons),
      this.progress,
    );
  }

  private number(name: string, value: number): HTMLInputElement {
    return make("input", { type: "number", min: 16, max: kLargest, step: 1, value, "aria-label": `${name} of pictures in pixels` });
  }

  private async run(job: () => Promise<void>): Promise<void> {
    if (this.busy) return;
    this.busy = true;
    try {
      await job();
    } catch (error) {
      say((error as Error).message, "error");
    } finally {
      this.busy = false;
      this.progress.textContent = "";
    }
  }

  private still(): Promise<Blob> {
    const [width, height] = [this.width.valueAsNumber, this.height.valueAsNumber];
    if (!(width >= 16 && width <= kLargest && height >= 16 && height <= kLargest)) throw new Error(`Pictures have 16 to ${kLargest} pixels a side.`);
    return stillPicture(this.what.viewers(), { width, height, scale: this.withBar ? this.what.scale() : null, caption: this.what.caption() });
  }

  private async png(): Promise<void> {
    download(`${this.what.name}_frame${this.what.current() + 1}.png`, await this.still());
  }

  private async animation(): Promise<void> {
    const before = this.what.current();
    const stills: Uint8Array[] = [];
    for (let frame = 0; frame < this.what.frames; ++frame) {
      this.progress.textContent = `Picture ${frame + 1} of ${this.what.frames} …`;
      await this.what.show(frame);
      stills.push(new Uint8Array(await (await this.still()).arrayBuffer()));
    }
    await this.what.show(before);
    download(`${this.what.name}.png`, new Blob([animatedPng(stills, kFrameMs)], { type: "image/apng" }));
  }
}
