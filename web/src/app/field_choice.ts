import { ColourBar } from "../colour/bar";
import type { MapName } from "../colour/maps";
import { rangeOf, type Scale } from "../colour/scale";
import { readable, type Case } from "../core/case";
import { labelled, make, select } from "../core/dom";
import { kSurfaceFields } from "../core/surface_fields";
import type { Bundle } from "../core/bundle";
import type { HipModel } from "../scene/hip_model";

type RangeMode = "fixed" | "frame" | "own";

/** What surfaces are coloured by: field, map and range; with the colour bar that says so. */
export class FieldChoice {
  readonly element = make("div");
  readonly bar = new ColourBar();
  scale: Scale | null = null;
  field: string | null = null;
  /** A second result, coloured alike: one range for both. */
  second: { hip: HipModel; frames: () => Bundle[] } | null = null;
  private map: MapName = "viridis";
  private readonly ranges = new Map<string, [number, number]>();
  private mode: RangeMode = "fixed";
  private readonly low = make("input", { type: "number", step: "any", "aria-label": "Lowest value", disabled: true });
  private readonly high = make("input", { type: "number", step: "any", "aria-label": "Highest value", disabled: true });
  private readonly fieldSelect: HTMLSelectElement;

  constructor(
    private readonly info: Case,
    private readonly hip: HipModel,
    private readonly frames: () => Bundle[],
    private readonly onChange: () => void,
  ) {
    const known = [...(info.bodies.length > 0 ? info.fields : []), ...(info.surfaces.length > 0 ? kSurfaceFields : [])];
    this.fieldSelect = select([["", "structures' own colours"], ...known.map((f): [string, string] => [f.key, f.label])], (value) => {
      this.field = value || null;
      this.onChange();
    });
    this.fieldSelect.dataset["testid"] = "field";
    const mapSelect = select([["viridis", "viridis"], ["cividis", "cividis"]], (value) => {
      this.map = value as MapName;
      this.onChange();
    });
    const modeSelect = select([["fixed", "the same for all frames"], ["frame", "of each frame"], ["own", "typed in"]], (value) => {
      this.mode = value as RangeMode;
      this.low.disabled = this.high.disabled = value !== "own";
      this.onChange();
    });
    modeSelect.dataset["testid"] = "range";
    for (const input of [this.low, this.high]) input.addEventListener("change", () => this.onChange());
    this.element.append(
      make("h2", {}, "Colour"),
      labelled("Coloured by", this.fieldSelect),
      labelled("Colour map", mapSelect),
      labelled("Range", modeSelect),
      make("div", { class: "row pair" }, this.low, this.high),
    );
  }

  choose(field: string): void {
    this.fieldSelect.value = field;
    this.field = this.fieldSelect.value || null;
  }

  /** Works out the scale and colours the hip with it. */
  apply(): void {
    this.scale = this.field ? this.scaleOf(this.field) : null;
    this.hip.colour(this.field, this.scale);
    this.second?.hip.colour(this.field, this.scale);
    this.bar.show(this.scale);
  }

  label(field: string): string {
    const known = [...this.info.fields, ...kSurfaceFields].find((f) => f.key === field);
    return known ? `${known.label}${known.unit ? ` [${known.unit}]` : ""}` : readable(field);
  }

  /** Over all frames that are here; worked out again only when another has come. */
  private fixedRange(field: string): [number, number] {
    const frames = this.frames();
    const others = this.second?.frames() ?? [];
    const key = `${field} ${frames.length} ${others.length}`;
    let found = this.ranges.get(key);
    if (!found) this.ranges.set(key, (found = this.rangeOver(field, frames, others)));
    return found;
  }

  private rangeOver(field: string, frames: Bundle[], others: Bundle[]): [number, number] {
    return rangeOf([...this.hip.arrays(field, frames), ...(this.second?.hip.arrays(field, others) ?? [])]);
  }

  private scaleOf(field: string): Scale {
    const typed: [number, number] = [this.low.valueAsNumber, this.high.valueAsNumber];
    let [low, high] = this.mode === "fixed" ? this.fixedRange(field) : this.rangeOver(field, [], []);
    if (this.mode === "own" && typed[1] > typed[0]) [low, high] = typed;
    else {
      this.low.value = low.toPrecision(3);
      this.high.value = high.toPrecision(3);
    }
    return { map: this.map, low, high, label: this.label(field) };
  }
}
