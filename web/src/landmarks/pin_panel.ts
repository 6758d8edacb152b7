import { api, type Landmark } from "../core/api";
import { readable, type Vec3 } from "../core/case";
import { button, labelled, make, select } from "../core/dom";
import { PointStore } from "./point_store";

/** The next free name of a structure's pins: femur-1, femur-2, … */
export function nextPin(structure: string, taken: readonly Landmark[]): string {
  const numbers = taken.filter((pin) => pin.name.startsWith(`${structure}-`)).map((pin) => Number(pin.name.slice(structure.length + 1)) || 0);
  return `${structure}-${Math.max(0, ...numbers) + 1}`;
}

/** Points that a structure's surface must pass through: set at the cross-hair, moved on the slices. */
export class PinPanel {
  readonly element = make("section", { "aria-label": "Pins" });
  readonly store: PointStore;
  private structure = "";
  private readonly entries = make("ul", { class: "landmarks" });
  private readonly undo = button("Undo pin", () => this.store.change((list) => list.undo()));
  private readonly redo = button("Redo pin", () => this.store.change((list) => list.redo()));

  /**
   * @param focus where the cross-hair is
   * @param onChange the pins are others now
   * @param go shows a place
   */
  constructor(focus: () => Vec3, private readonly onChange: () => void, private readonly go: (place: Vec3) => void) {
    this.store = new PointStore({ what: "Pins", load: () => api.pins(), save: (version, points) => api.savePins(version, points) }, () => this.show());
    const place = button("Pin at cross-hair", () => {
      const name = nextPin(this.structure, this.store.list.landmarks);
      this.store.change((list) => list.place(name, focus()));
    }, { "data-testid": "pin" });
    this.element.append(make("h2", {}, "Correct a contour"), make("div"), make("div", { class: "buttons" }, place, this.undo, this.redo), this.entries);
    this.element.append(make("p", { class: "note" }, "A pin is a point that the structure's surface passes through. Set the cross-hair where the border is, pin it, then segment again: the surface is bent to its pins within seconds."));
  }

  get pins(): readonly Landmark[] {
    return this.store.list.landmarks;
  }

  private show(): void {
    if (!this.structure) this.chooseStructure();
    this.undo.disabled = !this.store.list.canUndo;
    this.redo.disabled = !this.store.list.canRedo;
    this.entries.replaceChildren(
      ...this.pins.map((pin) =>
        make(
          "li",
          {},
          button(pin.name, () => this.go(pin.position_lps_mm), { class: "name" }),
          button("×", () => this.store.change((list) => list.remove(pin.name)), { class: "small", "aria-label": `Remove ${pin.name}` }),
        ),
      ),
    );
    this.onChange();
  }

  private chooseStructure(): void {
    const known = this.store.known;
    this.structure = known.includes("femur") ? "femur" : (known[0] ?? "");
    const choice = select(known.map((name): [string, string] => [name, readable(name)]), (value) => (this.structure = value));
    choice.value = this.structure;
    choice.dataset["testid"] = "pin-structure";
    this.element.children[1]?.replaceWith(labelled("Structure", choice));
  }
}
