import { Dialog } from "./dialog.tsx";
import { store } from "../store.ts";

const KEYS: [string, [string, string][]][] = [
  ["Everywhere", [
    ["Alt+1 to 4", "Live, Review, Zones, System"], ["?", "this help"], ["Esc", "close, deselect"],
    ["M", "mute for 5 min"],
  ]],
  ["Review", [
    ["J K", "next, previous"], ["X", "reviewed, or not"], ["C", "close as, then 1 to 4"],
    ["[ ]", "slower, faster"], ["Space", "pause, play"], ["← →", "1 s back, on"],
    [", .", "one picture back, on"],
  ]],
  ["Live", [
    ["A", "acknowledge the card that shows A"], ["R", "replay it"], ["G", "go to it"],
    ["L", "back to live"], ["Space", "pause, play"], ["← →", "1 s back, on"],
    [", .", "one picture back, on"], ["Home", "as far back as this page has seen"], ["1 to 9", "view of a camera"], ["0", "overview"],
    ["F", "plan"], ["O", "edge"], ["T", "follow the selected person"], ["Tab", "next person"],
    ["N", "layers"], ["/", "go to a time"],
  ]],
];

export function Help() {
  const close = () => store.set({ menu: null });
  return (
    <Dialog name="Help">
      <h2>Help</h2>
      <p>
        The sentence at the top left says whether all is well. It says “All clear” only while the
        data are fresh, every stage and camera works, and rules are armed.
      </p>
      <p>
        This page supports people on duty. It is not a certified safety function, and nothing
        that protects people may depend on it alone.
      </p>
      <div class="columns">
        {KEYS.map(([where, keys]) => (
          <section key={where}>
            <h3>{where}</h3>
            <dl>
              {keys.map(([key, what]) => (
                <><dt><b>{key}</b></dt><dd>{what}</dd></>
              ))}
            </dl>
          </section>
        ))}
      </div>
      <div class="row">
        <button type="button" class="button primary" autoFocus onClick={close}>Close</button>
      </div>
    </Dialog>
  );
}
