import { byId } from "../core/dom";

type Theme = "light" | "dark";
const kKey = "coxa-theme";

function wished(): Theme {
  const stored = localStorage.getItem(kKey);
  if (stored === "light" || stored === "dark") return stored;
  return matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
}

/** Light or dark: as the system says until the button says otherwise. */
export function startTheme(onChange: () => void): void {
  const button = byId<HTMLButtonElement>("theme");
  const apply = (theme: Theme): void => {
    document.documentElement.dataset["theme"] = theme;
    button.textContent = theme === "dark" ? "Light" : "Dark";
    onChange();
  };
  button.addEventListener("click", () => {
    const next: Theme = document.documentElement.dataset["theme"] === "dark" ? "light" : "dark";
    localStorage.setItem(kKey, next);
    apply(next);
  });
  apply(wished());
}
