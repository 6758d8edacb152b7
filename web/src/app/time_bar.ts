import { button, byId, make, range } from "../core/dom";

const kFrameMs = 350;

/** Slider over the frames, with play. */
export class TimeBar {
  private readonly slider: HTMLInputElement;
  private readonly play: HTMLButtonElement;
  private readonly text = make("output", { "aria-live": "off" });
  private timer: ReturnType<typeof setInterval> | undefined;

  constructor(
    private readonly count: number,
    private readonly onFrame: (frame: number) => void,
    private readonly describe: (frame: number) => string,
  ) {
    this.slider = range(0, count - 1, 1, 0, (frame) => this.onFrame(frame));
    this.slider.setAttribute("aria-label", "Frame");
    this.play = button("Play", () => this.toggle(), { "aria-pressed": "false" });
    this.mount();
  }

  mount(): void {
    byId("time").replaceChildren(this.play, this.slider, this.text);
  }

  set(frame: number): void {
    this.slider.value = String(frame);
    this.text.textContent = this.describe(frame);
    this.slider.setAttribute("aria-valuetext", this.text.textContent);
  }

  stop(): void {
    clearInterval(this.timer);
    this.timer = undefined;
    this.play.textContent = "Play";
    this.play.setAttribute("aria-pressed", "false");
  }

  private toggle(): void {
    if (this.timer !== undefined) return this.stop();
    this.play.textContent = "Pause";
    this.play.setAttribute("aria-pressed", "true");
    this.timer = setInterval(() => this.onFrame((this.slider.valueAsNumber + 1) % this.count), kFrameMs);
  }
}
