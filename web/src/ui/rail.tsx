import { Icon, type IconName } from "./icons.tsx";
import { useStore } from "./use.ts";
import { faults } from "./top.tsx";
import { handling } from "../state/alerts.ts";
import { PAGES, type Page } from "../state/address.ts";
import { dataTime, open } from "../state/state.ts";
import { store, type Store } from "../store.ts";
import { signOut } from "../net/api.ts";

const NAMES: Record<Page, [string, IconName]> = {
  live: ["Live", "live"], review: ["Review", "review"], zones: ["Zones", "zones"],
  system: ["System", "system"],
};

function badge(page: Page, shop: Store): { n: number; look: string; words: string } | null {
  const { state } = shop;
  const now = dataTime(state);
  if (page === "live") {
    const alerts = open(state).filter((alert) => handling(alert, now) !== "shelved");
    const worst = alerts[0]?.severity ?? "";
    return { n: alerts.length, look: worst, words: "open alerts" };
  }
  if (page === "review") {
    const left = [...state.alerts.values()]
      .filter((a) => a.end !== null && !a.closed && !shop.reviewed.has(a.id));
    return { n: left.length, look: "", words: "to review" };
  }
  if (page === "system") return { n: faults(state).length, look: "warning", words: "faults" };
  return null;
}

export function Rail() {
  const shop = useStore();
  return (
    <aside class="rail" aria-label="Pages, help and settings">
      <div class="brand" title={shop.state.site?.name ?? "trecsim"}><Icon name="brand" size={26} /></div>
      <nav aria-label="Pages">
        {PAGES.map((page) => <Tab key={page} page={page} shop={shop} />)}
      </nav>
      <div class="end"><Small shop={shop} /></div>
    </aside>
  );
}

function Tab({ page, shop }: { page: Page; shop: Store }) {
  const [name, icon] = NAMES[page];
  const count = badge(page, shop);
  const current = shop.address.page === page;
  return (
    <a
      class="tab" href={`/${page}`} aria-current={current ? "page" : undefined}
      onClick={(event) => {
        if (event.metaKey || event.ctrlKey || event.shiftKey) return;
        event.preventDefault();
        store.page(page);
      }}
    >
      <Icon name={icon} size={22} />
      {name}
      {count && count.n > 0 && (
        <span class={`badge ${count.look}`}>
          {count.n}<span class="hidden"> {count.words}</span>
        </span>
      )}
    </a>
  );
}

function Small({ shop }: { shop: Store }) {
  const dark = document.documentElement.dataset.theme === "dark";
  const { me } = shop.state;
  return (
    <>
      <button type="button" class="small" aria-label="Help" title="Help (?)"
        onClick={() => store.set({ menu: "help" })}>
        <Icon name="help" size={20} />
      </button>
      <button type="button" class="small" aria-label={dark ? "Light theme" : "Dark theme"}
        title={dark ? "Light theme" : "Dark theme"}
        onClick={() => store.set({ theme: dark ? "light" : "dark" })}>
        <Icon name={dark ? "sun" : "moon"} size={20} />
      </button>
      <button type="button" class="small" aria-label="User" title="User"
        aria-expanded={shop.own.menu === "user"}
        onClick={() => store.set({ menu: shop.own.menu === "user" ? null : "user" })}>
        <Icon name="user" size={20} />
      </button>
      {shop.own.menu === "user" && (
        <div class="menu">
          <p>
            {me?.user
              ? `${me.user}, signed in as ${me.role ?? "viewer"}.`
              : "This server has no users. Whoever reaches the page may act."}
          </p>
          <h3>Theme</h3>
          {(["system", "light", "dark"] as const).map((theme) => (
            <label key={theme}>
              <input type="radio" name="theme" checked={shop.own.theme === theme}
                onChange={() => store.set({ theme })} />
              {theme === "system" ? "As this device" : theme === "light" ? "Light" : "Dark"}
            </label>
          ))}
          {me?.user && (
            <button type="button" onClick={async () => {
              await signOut(me.csrf ?? null).catch(() => null);
              location.assign("/");
            }}>Sign out</button>
          )}
        </div>
      )}
    </>
  );
}
