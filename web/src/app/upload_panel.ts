import { api } from "../core/api";
import { button, labelled, make, readEntries, say, select } from "../core/dom";

const kLargest = 512 * 2 ** 20; // bytes a file, as the server has it
const kImages = [".nii", ".nii.gz", ".nrrd", ".mha"];

export interface Chosen {
  files: File[];
  fault: string; // why they cannot be sent; empty when they can
}

/** One image file, or all files of a DICOM folder. Files that no DICOM folder needs are left out. */
export function chosenFrom(all: File[]): Chosen {
  const hidden = (file: File): boolean => file.name.startsWith(".") || file.name === "DICOMDIR" || file.size === 0;
  const files = all.filter((file) => !hidden(file));
  const isImage = (file: File): boolean => kImages.some((end) => file.name.toLowerCase().endsWith(end));
  const images = files.filter(isImage);
  if (files.length === 0) return { files, fault: "There is nothing in it." };
  const large = files.find((file) => file.size > kLargest);
  if (large) return { files, fault: `${large.name} is larger than 512 MB.` };
  if (images.length > 1) return { files, fault: "Choose one image file, or one DICOM folder." };
  return { files: images.length === 1 ? images : files, fault: "" };
}

function randomName(): string {
  return [...crypto.getRandomValues(new Uint8Array(8))].map((byte) => byte.toString(16).padStart(2, "0")).join("");
}

/** An image is dropped or chosen, and sent into the subject's folder; nothing leaves this computer. */
export class UploadPanel {
  readonly element = make("section", { "aria-label": "Image of the subject", class: "upload" });
  private readonly progress = make("progress", { max: 1, value: 0, hidden: true, "aria-label": "Sending" });
  private readonly text = make("p", { class: "note", role: "status" }, "Nothing leaves this computer: the files go into the subject's folder.");
  private side = "right";
  private movement = "flexion";
  private readonly series = make("input", { type: "text", size: 8 });
  private busy = false;
  private sent: string | null = null; // a batch that waits for its series

  /** @param drop where files may be dropped */
  constructor(movements: string[], drop: HTMLElement, private readonly onTaken: () => void) {
    const movement = select(movements.map((name): [string, string] => [name, name.replaceAll("_", " ")]), (value) => (this.movement = value));
    movement.value = this.movement;
    const file = this.input("Choose an image file …", { accept: kImages.join(","), "data-testid": "choose-file" });
    const folder = this.input("Choose a DICOM folder …", { webkitdirectory: true, "data-testid": "choose-folder" });
    this.element.append(
      make("h2", {}, "Start from an MRI"),
      make("p", {}, "Drop a DICOM folder or a NIfTI, NRRD or MetaImage file here, or choose one."),
      labelled("Side of the hip", select([["right", "right"], ["left", "left"]], (value) => (this.side = value))),
      labelled("Movement to simulate", movement),
      labelled("Series, of a DICOM folder with several", this.series),
      make("div", { class: "buttons" }, file, folder),
      this.progress,
      this.text,
    );
    this.series.addEventListener("change", () => this.sent && void this.take(this.sent));
    drop.addEventListener("dragover", (event) => {
      event.preventDefault();
      drop.classList.add("dropping");
    });
    drop.addEventListener("dragleave", () => drop.classList.remove("dropping"));
    drop.addEventListener("drop", (event) => {
      event.preventDefault();
      drop.classList.remove("dropping");
      if (event.dataTransfer) void readEntries(event.dataTransfer).then((files) => this.send(files));
    });
  }

  private input(text: string, attributes: Record<string, string | boolean>): HTMLButtonElement {
    const input = make("input", { type: "file", hidden: true, ...attributes });
    input.addEventListener("change", () => void this.send([...(input.files ?? [])]));
    this.element.append(input);
    return button(text, () => input.click());
  }

  async send(all: File[]): Promise<void> {
    const { files, fault } = chosenFrom(all);
    if (fault) return this.say(fault, true);
    if (this.busy) return;
    this.busy = true;
    this.progress.hidden = false;
    try {
      const batch = randomName();
      for (const [i, file] of files.entries()) {
        await api.upload(batch, file.name, file);
        this.progress.value = (i + 1) / files.length;
      }
      await this.take(batch);
    } catch (error) {
      this.say((error as Error).message, true);
    } finally {
      this.busy = false;
      this.progress.hidden = true;
    }
  }

  private async take(batch: string): Promise<void> {
    this.sent = batch;
    try {
      await api.takeImage({ batch, side: this.side, movement: this.movement, series: this.series.value.trim() });
      this.sent = null;
      this.onTaken();
    } catch (error) {
      this.say((error as Error).message, true);
    }
  }

  private say(text: string, bad: boolean): void {
    this.text.textContent = text;
    this.text.classList.toggle("bad", bad);
    say(text, bad ? "error" : "plain");
  }
}
