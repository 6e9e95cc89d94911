// Bundle the unit tests as the page is bundled, then run them with Node's own test runner.
import { spawnSync } from "node:child_process";
import { readdirSync, rmSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { build } from "vite";

const here = fileURLToPath(new URL(".", import.meta.url));
const out = fileURLToPath(new URL("../.tests/", import.meta.url));
const tests = readdirSync(here).filter((name) => name.endsWith(".test.ts"));

rmSync(out, { recursive: true, force: true });
await build({
  root: here,
  configFile: false,
  logLevel: "error",
  build: {
    ssr: true,
    outDir: out,
    minify: false,
    rollupOptions: { input: tests.map((name) => here + name) },
  },
});
const files = tests.map((name) => `${out}${name.replace(/\.ts$/, ".js")}`);
const done = spawnSync(process.execPath, ["--test", "--test-reporter=dot", ...files], {
  stdio: "inherit",
});
process.exit(done.status ?? 1);
