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

  constructor() {
    const grey = make("div", { class: "no-value" }, make("span", { class: "swatch" }), "no value");
    (grey.firstElementChild as HTMLElement).style.background = css(noValue);
    this.element.append(this.caption, make("div", { class: "scale" }, this.canvas, this.ticks), grey);
  }

  show(scale: Scale | null): void {
    this.element.hidden = scale === null;
    if (!scale) return;
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
