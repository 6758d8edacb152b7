import { make } from "../core/dom";
import { niceTicks, shortNumber } from "../core/numbers";
import { css, mapColour, noValue } from "./maps";
import { share, type Scale } from "./scale";

/** An upright colour bar with its numbers and label, as DOM so that it stays sharp and readable. */
export class ColourBar {
  readonly element = make("figure", { class: "colour-bar", hidden: true });
  private readonly canvas = make("canvas", { width: 1, height: 256, "aria-hidden": "true" });
  private readonly ticks = make("div", { class: "ticks" });
  private readonly caption = make("figcaption");
  private shown = "";

  constructor() {
    const grey = make("div", { class: "no-value" }, make("span", { class: "swatch" }), "no value");
    (grey.firstElementChild as HTMLElement).style.background = css(noValue);
    this.element.append(this.caption, make("div", { class: "scale" }, this.canvas, this.ticks), grey);
  }

  show(scale: Scale | null): void {
    this.element.hidden = scale === null;
    const key = JSON.stringify(scale);
    if (!scale || key === this.shown) return; // led live, it is asked for at every answer
    this.shown = key;
    const context = this.canvas.getContext("2d");
    for (let y = 0; context && y < 256; ++y) {
      context.fillStyle = css(mapColour(scale.map, 1 - y / 255));
      context.fillRect(0, y, 1, 1);
    }
    this.caption.textContent = scale.label;
    this.ticks.replaceChildren(
      ...niceTicks(scale.low, scale.high).map((value) => {
        const tick = make("span", {}, shortNumber(value));
        tick.style.bottom = `${100 * share(scale, value)}%`;
        return tick;
      }),
    );
  }
}

/** The same into a picture, its upper left corner at (left, top), in letters of `size`; `ink` is their colour. */
export function drawBar(context: CanvasRenderingContext2D, scale: Scale, left: number, top: number, size: number, ink: string): void {
  const height = 14 * size;
  context.font = `${size}px system-ui, "DejaVu Sans", sans-serif`;
  context.textBaseline = "middle";
  const from = top + 2.5 * size;
  for (let y = 0; y < height; ++y) {
    context.fillStyle = css(mapColour(scale.map, 1 - y / (height - 1)));
    context.fillRect(left + 0.5 * size, from + y, 1.2 * size, 1.5);
  }
  context.fillStyle = ink;
  context.textAlign = "left";
  context.fillText(scale.label, left + 0.5 * size, top + size);
  for (const value of niceTicks(scale.low, scale.high)) context.fillText(`– ${shortNumber(value)}`, left + 2 * size, from + (1 - share(scale, value)) * height);
}
