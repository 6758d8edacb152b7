import { css, structureColours } from "../colour/maps";
import { readable, type Clock, type Vec3 } from "../core/case";
import { button, checkbox, labelled, make, range, select } from "../core/dom";
import { times } from "../core/dots";
import { viewpoints, type Viewer } from "../scene/viewer";

const kBoneOpacity = 30; // %, so that the cartilage is seen at once

/** Opacity of each surface, the clip plane, and the viewpoints. */
export class SceneControls {
  readonly element = make("div");
  private clip = { on: false, axis: "sagittal", offset: 0, flipped: false };

  constructor(
    private readonly viewer: Viewer,
    private readonly centre: Vec3,
  ) {
    this.element.append(make("h2", {}, "Surfaces"), ...[...viewer.layers.keys()].map((name) => this.opacity(name)), ...this.clipControls());
  }

  private opacity(name: string): HTMLElement {
    const layer = this.viewer.layers.get(name);
    const first = name.endsWith("cartilage") ? 100 : kBoneOpacity;
    layer?.setOpacity(first / 100);
    const shown = make("output", {}, `${first} %`);
    const input = range(0, 100, 5, first, (value) => {
      layer?.setOpacity(value / 100);
      shown.textContent = `${value} %`;
      this.viewer.invalidate();
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
    const apply = (): void => {
      const normals: Record<string, Vec3> = { sagittal: [1, 0, 0], coronal: [0, 1, 0], axial: [0, 0, 1] };
      const along = normals[this.clip.axis] ?? [1, 0, 0];
      const normal = this.clip.flipped ? times(-1, along) : along;
      const place = along[0] * this.centre[0] + along[1] * this.centre[1] + along[2] * this.centre[2] + this.clip.offset;
      this.viewer.setClip(this.clip.on, normal, this.clip.flipped ? place : -place);
    };
    const axis = select([["sagittal", "sagittal"], ["coronal", "coronal"], ["axial", "axial"]], (value) => {
      this.clip.axis = value;
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
export function viewpointButtons(viewer: Viewer, clock: Clock | undefined): HTMLElement[] {
  const show = (hidden: string[]): void => {
    for (const [name, layer] of viewer.layers) layer.mesh.visible = !hidden.includes(name) && layer.mesh.material.opacity > 0;
  };
  const buttons = Object.entries(viewpoints).map(([name, from]) =>
    button(name, () => {
      show([]);
      viewer.look(from);
    }),
  );
  if (clock) {
    buttons.push(
      button("into the socket", () => {
        show(["femur", "femoral_cartilage"]);
        viewer.look(clock.axis, ["acetabular_cartilage"], clock.twelve);
      }),
      button("onto the head", () => {
        show(["hip_bone", "acetabular_cartilage"]);
        viewer.look(times(-1, clock.axis), ["femoral_cartilage"], clock.twelve);
      }),
    );
  }
  return buttons;
}
