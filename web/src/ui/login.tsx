import { useState } from "preact/hooks";
import { Icon } from "./icons.tsx";
import { signIn } from "../net/api.ts";
import { store } from "../store.ts";

export function Login() {
  const [user, setUser] = useState("");
  const [password, setPassword] = useState("");
  const [fault, setFault] = useState("");
  const [busy, setBusy] = useState(false);
  const submit = async (event: Event) => {
    event.preventDefault();
    setBusy(true);
    setFault("");
    try {
      await signIn(user, password);
      await store.start();
    } catch (error) {
      setFault(error instanceof TypeError
        ? "The server does not answer. Try again."
        : error instanceof Error ? error.message : String(error));
    }
    setPassword("");
    setBusy(false);
  };
  return (
    <main class="login">
      <form onSubmit={submit}>
        <h1><Icon name="brand" size={24} />Sign in</h1>
        <label>
          Name
          <input class="field" name="user" autocomplete="username" required autoFocus
            value={user} onInput={(event) => setUser(event.currentTarget.value)} />
        </label>
        <label>
          Password
          <input class="field" name="password" type="password" autocomplete="current-password"
            required value={password} onInput={(event) => setPassword(event.currentTarget.value)} />
        </label>
        {fault && <p class="fault" role="alert">{fault}</p>}
        <button type="submit" class="button primary" disabled={busy}>
          {busy && <span class="spin"><Icon name="connecting" size={16} /></span>}Sign in
        </button>
      </form>
    </main>
  );
}
