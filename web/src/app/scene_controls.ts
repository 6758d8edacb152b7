import { css, structureColours } from "../colour/maps";
import { readable, type Clock, type Vec3 } from "../core/case";
import { button, checkbox, labelled, make, range, select } from "../core/dom";
import { dot, times } from "../core/dots";
import { viewpoints, type Viewer } from "../scene/viewer";
import type { Orientation } from "../slices/volume";

const kNormals: Record<Orientation, Vec3> = { sagittal: [1, 0, 0], coronal: [0, 1, 0], axial: [0, 0, 1] };
const kBoneOpacity = 30; // %, so that the cartilage is seen at once

/** A view and the place in it that distances count from. */
export interface View {
  viewer: Viewer;
  centre: Vec3;
}

/** Opacity of each surface, the clip plane, and the viewpoints, of one view or of several alike. */
export class SceneControls {
  readonly element = make("div");
  /** The clip plane stands somewhere else now. */
  onClip: ((orientation: Orientation, offset: number) => void) | null = null;
  private readonly views: View[];
  private readonly opacities = new Map<string, number>();
  private clip = { on: false, axis: "sagittal" as Orientation, offset: 0, flipped: false };

  constructor(view: View) {
    this.views = [view];
    this.element.append(make("h2", {}, "Surfaces"), ...[...view.viewer.layers.keys()].map((name) => this.opacity(name)), ...this.clipControls());
  }

  /** Another view that looks alike from now on. */
  add(view: View): void {
    this.views.push(view);
    for (const [name, opacity] of this.opacities) this.setOpacity(name, opacity);
    this.applyClip();
  }

  private setOpacity(name: string, percent: number): void {
    this.opacities.set(name, percent);
    for (const { viewer } of this.views) {
      viewer.layers.get(name)?.setOpacity(percent / 100);
      viewer.invalidate();
    }
  }

  private applyClip(): void {
    const { on, axis, offset, flipped } = this.clip;
    const along = kNormals[axis];
    const normal = flipped ? times(-1, along) : along;
    for (const { viewer, centre } of this.views) {
      const place = dot(along, centre) + offset;
      viewer.setClip(on, normal, flipped ? place : -place);
    }
    if (on) this.onClip?.(axis, offset);
  }

  private opacity(name: string): HTMLElement {
    const first = name.endsWith("cartilage") ? 100 : kBoneOpacity;
    this.setOpacity(name, first);
    const shown = make("output", {}, `${first} %`);
    const input = range(0, 100, 5, first, (value) => {
      this.setOpacity(name, value);
      shown.textContent = `${value} %`;
    });
    input.dataset["layer"] = name;
    const row = labelled(`${readable(name)}`, input);
    row.insertBefore(shown, input);
    const swatch = make("span", { class: "swatch" });
    swatch.style.background = css(structureColours[name] ?? [153, 153, 153]);
    row.querySelector("label")?.prepend(swatch, " ");
    return row;
  }

  private clipControls(): HTMLElement[] {
    const apply = (): void => this.applyClip();
    const axis = select([["sagittal", "sagittal"], ["coronal", "coronal"], ["axial", "axial"]], (value) => {
      this.clip.axis = value as Orientation;
      apply();
    });
    const shown = make("output", {}, "0 mm");
    const offset = range(-80, 80, 1, 0, (value) => {
      this.clip.offset = value;
      shown.textContent = `${value} mm`;
      apply();
    });
    const row = labelled("Distance from the joint centre", offset);
    row.insertBefore(shown, offset);
    return [
      make("h2", {}, "Clip plane"),
      checkbox("Cut the surfaces open", false, (on) => {
        this.clip.on = on;
        apply();
      }),
      labelled("Plane", axis),
      row,
      checkbox("Keep the other side", false, (on) => {
        this.clip.flipped = on;
        apply();
      }),
    ];
  }
}

/** Buttons for the usual viewpoints; those of the joint hide what stands before it. */
export function viewpointButtons(viewers: () => Viewer[], clock: Clock | undefined): HTMLElement[] {
  const look = (...how: Parameters<Viewer["look"]>): void => viewers()[0]?.look(...how);
  const show = (hidden: string[]): void => {
    for (const viewer of viewers()) {
      for (const [name, layer] of viewer.layers) layer.mesh.visible = !hidden.includes(name) && layer.mesh.material.opacity > 0;
    }
  };
  const buttons = Object.entries(viewpoints).map(([name, from]) =>
    button(name, () => {
      show([]);
      look(from);
    }),
  );
  if (clock) {
    buttons.push(
      button("into the socket", () => {
        show(["femur", "femoral_cartilage"]);
        look(clock.axis, ["acetabular_cartilage"], clock.twelve);
      }),
      button("onto the head", () => {
        show(["hip_bone", "acetabular_cartilage", "acetabular_labrum"]);
        look(times(-1, clock.axis), ["femoral_cartilage"], clock.twelve);
      }),
    );
  }
  return buttons;
}
