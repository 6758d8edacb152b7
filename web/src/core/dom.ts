/** Small helpers for building the page; no framework. */

export function byId<T extends HTMLElement = HTMLElement>(id: string): T {
  const element = document.getElementById(id);
  if (!element) throw new Error(`the page has no #${id}`);
  return element as T;
}

type Attributes = Record<string, string | number | boolean>;

export function make<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: (Node | string)[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes)) {
    if (typeof value === "boolean") element.toggleAttribute(key, value);
    else element.setAttribute(key, String(value));
  }
  element.append(...children);
  return element;
}

export function button(text: string, onClick: () => void, attributes: Attributes = {}): HTMLButtonElement {
  const element = make("button", { type: "button", ...attributes }, text);
  element.addEventListener("click", onClick);
  return element;
}

let counter = 0;
/** A label with its control, joined by an id. */
export function labelled(text: string, control: HTMLInputElement | HTMLSelectElement, ...after: Node[]): HTMLElement {
  control.id ||= `control-${++counter}`;
  return make("div", { class: "row" }, make("label", { for: control.id }, text), control, ...after);
}

export function checkbox(text: string, checked: boolean, onChange: (on: boolean) => void): HTMLElement {
  const input = make("input", { type: "checkbox", checked });
  input.checked = checked;
  input.addEventListener("change", () => onChange(input.checked));
  return make("label", { class: "check" }, input, text);
}

export function select(options: [value: string, text: string][], onChange: (value: string) => void): HTMLSelectElement {
  const element = make("select");
  for (const [value, text] of options) element.append(make("option", { value }, text));
  element.addEventListener("change", () => onChange(element.value));
  return element;
}

export function range(min: number, max: number, step: number, value: number, onInput: (value: number) => void): HTMLInputElement {
  const input = make("input", { type: "range", min, max, step, value });
  input.addEventListener("input", () => onInput(input.valueAsNumber));
  return input;
}

/** Says something in the line at the foot of the page, which screen readers announce. */
export function say(text: string, kind: "plain" | "error" = "plain"): void {
  const line = byId("status");
  line.textContent = text;
  line.dataset["kind"] = kind;
}

export function download(name: string, content: Blob | string, type = "text/csv"): void {
  const blob = typeof content === "string" ? new Blob([content], { type }) : content;
  const link = make("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** All files of what was dropped, folders opened. */
export async function readEntries(data: DataTransfer): Promise<File[]> {
  const entries = [...data.items].map((item) => item.webkitGetAsEntry()).filter((entry) => entry !== null);
  if (entries.length === 0) return [...data.files];
  return (await Promise.all(entries.map(filesOf))).flat();
}

async function filesOf(entry: FileSystemEntry): Promise<File[]> {
  if (entry.isFile) return [await new Promise<File>((done, fail) => (entry as FileSystemFileEntry).file(done, fail))];
  const reader = (entry as FileSystemDirectoryEntry).createReader();
  const all: File[] = [];
  for (;;) {
    // a folder is given in parts, the last of them empty
    const some = await new Promise<FileSystemEntry[]>((done, fail) => reader.readEntries(done, fail));
    if (some.length === 0) return all;
    for (const one of some) all.push(...(await filesOf(one)));
  }
}
