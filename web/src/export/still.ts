import { drawBar } from "../colour/bar";
import type { Scale } from "../colour/scale";
import { make } from "../core/dom";
import type { Viewer } from "../scene/viewer";

export interface Still {
  width: number;
  height: number;
  scale: Scale | null; // with its colour bar; null: without
  caption: string;
}

/** The 3D view as a picture with colour bar and caption, whatever the window's size. */
export async function stillPicture(viewers: Viewer[], { width, height, scale, caption }: Still): Promise<Blob> {
  const canvas = make("canvas", { width, height });
  const context = canvas.getContext("2d", { alpha: false });
  if (!context) throw new Error("the browser could not make the picture");
  const style = getComputedStyle(document.documentElement);
  const colour = (name: string): string => style.getPropertyValue(name).trim();
  const size = Math.max(6, Math.round(height / 50));
  context.font = `${size}px system-ui, "DejaVu Sans", sans-serif`;
  // the bar has a column of its own: it covers nothing
  const column = scale ? Math.ceil(Math.max(6 * size, context.measureText(scale.label).width + 1.5 * size)) : 0;
  const share = Math.max(1, Math.floor((width - column) / viewers.length));
  context.fillStyle = colour("--scene");
  context.fillRect(0, 0, width, height);
  viewers.forEach((viewer, i) => viewer.drawInto(context, i * share, 0, share, height, colour("--scene")));
  if (scale) drawBar(context, scale, width - column, size, size, colour("--ink"));
  context.font = `${size}px system-ui, "DejaVu Sans", sans-serif`;
  context.fillStyle = colour("--ink");
  context.textAlign = "left";
  context.textBaseline = "alphabetic";
  context.fillText(caption, size, height - size, width - 2 * size);
  const blob = await new Promise<Blob | null>((done) => canvas.toBlob(done, "image/png"));
  if (!blob) throw new Error("the browser could not make the picture");
  return blob;
}
