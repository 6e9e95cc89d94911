import { render } from "preact";
import { App } from "./ui/app.tsx";
import { listen } from "./ui/keys.ts";
import { sounds } from "./ui/sounds.ts";
import { forget } from "./draw/palette.ts";
import { store } from "./store.ts";

const dark = matchMedia("(prefers-color-scheme: dark)");

function theme(): void {
  const wanted = store.own.theme;
  const next = wanted === "system" ? (dark.matches ? "dark" : "light") : wanted;
  if (document.documentElement.dataset.theme === next) return;
  document.documentElement.dataset.theme = next;
  forget();
  store.draw();
}

theme();
store.subscribe(theme);
dark.addEventListener("change", theme);
listen();
sounds();
void store.start();
const page = document.getElementById("page") as HTMLElement;
page.replaceChildren();
render(<App />, page);
document.documentElement.dataset.started = "";
