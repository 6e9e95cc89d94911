"""Who may do what at a page with users, and what an attacker finds."""

import asyncio
import itertools
import os
import shutil
import socket
import ssl
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from time import time

import httpx
import pytest
from argon2 import PasswordHasher, extract_parameters
from websockets.exceptions import ConnectionClosed, InvalidStatus

import trecsim
from made_page import SITE, RunningPage, event, next_of, run_apart, running_page, until
from made_tracks import snapshot
from page_processes import linux, process_of
from trecsim.errors import InputError
from trecsim.page import access, passwords
from trecsim.page.address import PageAddress
from trecsim.page.page_data import PageData
from trecsim.page.page_process import PageProcess
from trecsim.page.passwords import PasswordCheck, TooManyLoginsError, fits, hashed
from trecsim.page.tls_door import HANDSHAKES
from trecsim.page.users_file import ROLES, User, read_users, write_users
from trecsim.store.ledger import Ledger

PASSWORD = "a long password"
TOKEN = "a-token-of-twenty-characters"
FEEDS_TOKEN = "a-token-that-may-only-write"
HASH = PasswordHasher(time_cost=1, memory_cost=8, parallelism=1).hash(PASSWORD)  # a quick one
USERS = {name: User(name, name, HASH) for name in ROLES}


@pytest.fixture(scope="module")
def guarded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunningPage]:
    """Run a page with one user of each role, named as the role, and both tokens."""
    folder = tmp_path_factory.mktemp("guarded")
    write_users(folder / "users.toml", USERS)
    os.environ["TEST_PAGE_TOKEN"] = TOKEN
    os.environ["TEST_FEEDS_TOKEN"] = FEEDS_TOKEN
    address = PageAddress(
        port=0, users_file=folder / "users.toml", token_env="TEST_PAGE_TOKEN",
        trusted_proxy="127.0.0.1", hosts=("site.example",), feeds_token_env="TEST_FEEDS_TOKEN",
    )  # fmt: skip
    with running_page(address, PageData(ledger=folder / "ledger")) as page:
        page.process.event(event("opened"))
        with Ledger(folder / "ledger") as ledger:
            ledger.append_event(event("opened"))
        yield page
    del os.environ["TEST_PAGE_TOKEN"], os.environ["TEST_FEEDS_TOKEN"]


_ADDRESSES = (f"10.1.{high}.{low}" for high in range(256) for low in range(256))


def client_of(page: RunningPage, scheme: str = "https") -> httpx.Client:
    """Return a browser behind the trusted proxy, each at an address of its own."""
    headers = {"X-Forwarded-For": next(_ADDRESSES), "X-Forwarded-Proto": scheme}
    return httpx.Client(base_url=page.process.url, headers=headers, timeout=20)


def sign_in(page: RunningPage, user: str) -> httpx.Client:
    client = client_of(page)
    answer = client.post("/api/login", json={"user": user, "password": PASSWORD})
    assert answer.status_code == 200, answer.text
    key = answer.headers["set-cookie"].partition(";")[0]
    client.headers.update({"X-CSRF-Token": answer.json()["csrf"], "Cookie": key})
    return client


@contextmanager
def signed_in(page: RunningPage, user: str) -> Iterator[httpx.Client]:
    client = sign_in(page, user)
    yield client
    client.close()


@pytest.fixture(scope="module")
def clients(guarded: RunningPage) -> Iterator[dict[str, httpx.Client]]:
    token = client_of(guarded)
    token.headers["Authorization"] = f"Bearer {TOKEN}"
    feeder = client_of(guarded)
    feeder.headers["Authorization"] = f"Bearer {FEEDS_TOKEN}"
    found = {"nobody": client_of(guarded), "token": token, "feeds token": feeder}
    found |= {role: sign_in(guarded, role) for role in ROLES}
    yield found
    for client in found.values():
        client.close()


ALLOWED = {  # what each may do, from whom on
    ("GET", "/"): "nobody",
    ("GET", "/api/schema"): "nobody",
    ("GET", "/api/health"): "nobody",
    ("GET", "/api/me"): "viewer",
    ("GET", "/api/site"): "viewer",
    ("GET", "/api/events"): "viewer",
    ("GET", "/api/users/me/reviewed"): "viewer",
    ("GET", "/metrics"): "viewer",
    ("POST", "/api/users/me/reviewed"): "viewer",
    ("POST", "/api/events"): "operator",
    ("POST", "/api/events/opened"): "operator",
}
RANK = {"nobody": 0, "viewer": 1, "operator": 2, "token": 2, "admin": 3}


@pytest.mark.parametrize("who", RANK)
@pytest.mark.parametrize(("method", "path"), ALLOWED)
def test_each_role_may_do_what_it_may_and_nothing_else(
    clients: dict[str, httpx.Client], who: str, method: str, path: str
) -> None:
    body = {"events": [], "event": "opened", "phase": "reopen"} if method == "POST" else None
    status = clients[who].request(method, path, json=body).status_code
    if RANK[who] >= RANK[ALLOWED[method, path]]:
        assert status in (200, 503)
    else:
        assert status == (401 if who == "nobody" else 403)


@pytest.mark.parametrize(("method", "path"), ALLOWED)
def test_the_token_of_feeds_opens_nothing_but_what_everybody_may(
    clients: dict[str, httpx.Client], method: str, path: str
) -> None:
    body = {"events": [], "event": "opened", "phase": "reopen"} if method == "POST" else None
    answer = clients["feeds token"].request(method, path, json=body)
    if ALLOWED[method, path] == "nobody":
        assert answer.status_code in (200, 503)
    else:
        assert answer.status_code == 403
        assert answer.json() == {"error": "this token may only post messages of feeds"}


def test_the_token_of_feeds_sees_nobody(
    clients: dict[str, httpx.Client], guarded: RunningPage
) -> None:
    assert set(clients["feeds token"].get("/api/health").json()) == {"status"}
    headers = {
        "X-Forwarded-For": "10.2.0.2", "X-Forwarded-Proto": "https",
        "Authorization": f"Bearer {FEEDS_TOKEN}",
    }  # fmt: skip
    with pytest.raises(InvalidStatus) as refused, guarded.stream(additional_headers=headers):
        pass
    assert refused.value.response.status_code == 403


@pytest.mark.parametrize(
    ("who", "status"),
    [("nobody", 401), ("viewer", 403), ("operator", 403), ("token", 403), ("admin", 202),
     ("feeds token", 202)],
)  # fmt: skip
def test_only_the_token_of_feeds_and_admins_post_messages(
    clients: dict[str, httpx.Client], who: str, status: int
) -> None:
    answer = clients[who].post("/api/feeds/gate", json={"t_s": 1.0, "grant": "gate"})
    assert answer.status_code == status, answer.text


def test_an_admin_posts_no_messages_from_another_site(clients: dict[str, httpx.Client]) -> None:
    mark = {"X-CSRF-Token": ""}
    assert (
        clients["admin"].post("/api/feeds/gate", json={"t_s": 1}, headers=mark).status_code == 403
    )
    foreign = {"Origin": "https://evil.example"}
    for who in ("admin", "feeds token"):
        refused = clients[who].post("/api/feeds/gate", json={"t_s": 1}, headers=foreign)
        assert refused.status_code == 403
    assert clients["admin"].post("/api/feeds/gate", data={"t_s": "1"}).status_code == 415


def test_who_posts_messages_stands_once_in_the_audit_log(
    clients: dict[str, httpx.Client], guarded: RunningPage
) -> None:
    for _ in range(3):
        assert clients["feeds token"].post("/api/feeds/gate", json={"t_s": 1.0}).status_code == 202
    with Ledger(Path(guarded.process._setup.data["ledger"])) as ledger:
        posts = [entry for entry in ledger.audit() if entry.act == "post to feed"]
        told = repr(ledger.audit())
    assert [one.details["feed"] for one in posts if one.who == "feeds token"] == ["gate"]
    assert FEEDS_TOKEN not in told


def test_without_signing_in_health_tells_the_status_only(clients: dict[str, httpx.Client]) -> None:
    assert set(clients["nobody"].get("/api/health").json()) == {"status"}
    assert "cameras" in clients["viewer"].get("/api/health").json()


def test_the_cookie_is_out_of_reach_of_scripts_other_sites_and_plain_lines(
    guarded: RunningPage,
) -> None:
    with client_of(guarded) as client:
        answer = client.post("/api/login", json={"user": "viewer", "password": PASSWORD})
        cookie = answer.headers["set-cookie"].lower()
        assert {"httponly", "secure", "samesite=strict", "path=/"} <= set(cookie.split("; "))
        assert f"trecsim-{guarded.port}=" in cookie


def test_signing_in_gives_a_new_session_and_ends_the_one_before(guarded: RunningPage) -> None:
    with signed_in(guarded, "viewer") as client:
        before = client.headers["Cookie"]
        answer = client.post("/api/login", json={"user": "viewer", "password": PASSWORD})
        after = answer.headers["set-cookie"].partition(";")[0]
        assert after != before
        assert client.get("/api/site").status_code == 401
        assert client.get("/api/site", headers={"Cookie": after}).status_code == 200


def test_a_session_ends_with_signing_out_and_its_stream_with_it(guarded: RunningPage) -> None:
    with signed_in(guarded, "operator") as client:
        headers = {"Cookie": client.headers["Cookie"]}
        with guarded.stream(additional_headers=headers) as stream:
            next_of(stream, "health")
            assert client.post("/api/logout", json={}).status_code == 204
            assert client.get("/api/site").status_code == 401
            with pytest.raises(ConnectionClosed, match="signed out"):
                next_of(stream, "none of this kind")


@pytest.mark.parametrize("mark", [None, "", "wrong", "ä"])
def test_a_change_without_the_mark_of_the_page_is_refused(
    guarded: RunningPage, mark: str | None
) -> None:
    with signed_in(guarded, "operator") as client:
        del client.headers["X-CSRF-Token"]
        headers = {} if mark is None else {"X-CSRF-Token": mark.encode()}
        for path in ("/api/events/opened", "/api/logout", "/api/users/me/reviewed"):
            assert client.post(path, json={"phase": "ack"}, headers=headers).status_code == 403
        assert client.get("/api/me").json()["csrf"]


def test_a_form_of_another_site_cannot_change_anything(clients: dict[str, httpx.Client]) -> None:
    operator = clients["operator"]
    body = {"phase": "ack"}
    for headers in ({"Origin": "https://evil.example"}, {"Sec-Fetch-Site": "cross-site"}):
        refused = operator.post("/api/events/opened", json=body, headers=headers)
        assert refused.status_code == 403
    assert operator.post("/api/events/opened", data=body).status_code == 415
    login = {"user": "viewer", "password": PASSWORD}
    refused = clients["nobody"].post("/api/login", json=login, headers={"Origin": "null"})
    assert refused.status_code == 403


def test_a_wrong_password_and_an_unknown_name_look_the_same(guarded: RunningPage) -> None:
    answers = []
    for user, password in (("viewer", "wrong"), ("nobody", PASSWORD), ("", ""), ("x" * 900, "y")):
        with client_of(guarded) as client:
            answer = client.post("/api/login", json={"user": user, "password": password})
            answers.append((answer.status_code, answer.text, "set-cookie" in answer.headers))
    assert set(answers) == {(401, '{"error":"the name or the password is wrong"}', False)}


def test_passwords_cannot_be_tried_out(tmp_path: Path) -> None:
    write_users(tmp_path / "users.toml", USERS)
    address = PageAddress(port=0, users_file=tmp_path / "users.toml", trusted_proxy="127.0.0.1")
    with running_page(address) as page:
        with client_of(page) as client:
            tries = [
                client.post("/api/login", json={"user": "admin", "password": f"{n}"}).status_code
                for n in range(14)
            ]
            assert tries[:10] == [401] * 10
            assert tries[-1] == 429
            right = client.post("/api/login", json={"user": "admin", "password": PASSWORD})
            assert right.status_code == 429
        found = set()
        for number in range(14):  # from other addresses: the user's own limit
            with client_of(page) as client:
                body = {"user": "admin", "password": f"{number}"}
                found.add(client.post("/api/login", json=body).status_code)
        assert found == {401, 429}
        with client_of(page) as client:  # others are not locked out
            assert (
                client.post("/api/login", json={"user": "viewer", "password": PASSWORD}).status_code
                == 200
            )


def test_a_few_passwords_are_checked_at_once_and_too_many_are_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    running, most = [0], [0]
    go_on = threading.Event()

    def slow(password: str, known_hash: str | None) -> bool:
        running[0] += 1
        most[0] = max(most[0], running[0])
        go_on.wait(20)
        running[0] -= 1
        return True

    monkeypatch.setattr(passwords, "fits", slow)

    async def all_of_them() -> list[bool | BaseException]:
        check = PasswordCheck()
        tries = [asyncio.create_task(check.fits("a", "b")) for _ in range(12)]
        await asyncio.sleep(0.1)
        go_on.set()
        return await asyncio.gather(*tries, return_exceptions=True)

    found = run_apart(all_of_them())
    assert found.count(True) == 8
    assert [type(one) for one in found].count(TooManyLoginsError) == 4
    assert most[0] == 2


def test_a_password_is_kept_as_a_costly_hash_only() -> None:
    made = hashed(PASSWORD)
    facts = extract_parameters(made)
    assert (facts.type.name, facts.memory_cost, facts.time_cost) == ("ID", 65536, 3)
    assert fits(PASSWORD, made)
    assert not fits(PASSWORD + " ", made)
    assert not fits(PASSWORD, None)
    with pytest.raises(InputError, match="10 to 1000 characters, found 5"):
        hashed("12345")


@pytest.mark.parametrize("user", ["viewer", "admin"])
def test_a_password_over_a_plain_line_is_refused(guarded: RunningPage, user: str) -> None:
    with client_of(guarded, scheme="http") as client:
        answer = client.post("/api/login", json={"user": user, "password": PASSWORD})
        assert answer.status_code == 403
        assert "TLS" in answer.json()["error"]
        headers = {"Authorization": f"Bearer {TOKEN}"}
        assert client.get("/api/site", headers=headers).status_code == 403


@pytest.mark.parametrize("token", ["wrong", TOKEN[:-1], TOKEN + "x", "ä"])
def test_a_wrong_token_is_refused_everywhere(guarded: RunningPage, token: str) -> None:
    headers = {b"Authorization": f"Bearer {token}".encode()}
    with client_of(guarded) as client:
        for path in ("/api/site", "/api/events", "/metrics", "/api/health"):
            assert client.get(path, headers=headers).status_code == 401


def test_a_token_in_the_address_counts_nothing(clients: dict[str, httpx.Client]) -> None:
    for name in ("token", "access_token", "authorization"):
        assert clients["nobody"].get("/api/site", params={name: TOKEN}).status_code == 401


def test_the_stream_needs_a_cookie_or_a_token(guarded: RunningPage) -> None:
    proxied = {"X-Forwarded-For": "10.2.0.1", "X-Forwarded-Proto": "https"}
    guarded.process.write(snapshot(time(), [9]))
    with pytest.raises(InvalidStatus) as refused, guarded.stream(additional_headers=proxied):
        pass
    assert refused.value.response.status_code == 401
    headers = {**proxied, "Authorization": f"Bearer {TOKEN}"}
    with guarded.stream(additional_headers=headers) as stream:
        assert next_of(stream, "snapshot")["people"][0]["person"] == 9


def test_a_user_who_is_removed_or_demoted_loses_it_at_once(tmp_path: Path) -> None:
    file = tmp_path / "users.toml"
    write_users(file, USERS)
    data = PageData(ledger=tmp_path)
    address = PageAddress(port=0, users_file=file, trusted_proxy="127.0.0.1")
    with running_page(address, data) as page, signed_in(page, "operator") as client:
        demoted = replace(USERS["operator"], role="viewer")
        write_users(file, {**USERS, "operator": demoted})
        until(lambda: client.get("/api/me").json().get("role") == "viewer")
        assert client.post("/api/events/e", json={"phase": "ack"}).status_code == 403
        write_users(file, {name: user for name, user in USERS.items() if name != "operator"})
        until(lambda: client.get("/api/me").status_code == 401)
        with Ledger(tmp_path) as ledger:
            until(lambda: [entry.act for entry in ledger.audit()].count("users changed") == 2)
            roles = [entry.details.get("roles") for entry in ledger.audit()]
            assert {"operator": "viewer"} in roles
            assert ledger.verify_audit().is_whole


def test_a_file_of_users_that_is_gone_is_told_once_and_lets_in_who_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    file = tmp_path / "users.toml"
    write_users(file, USERS)
    now_s = itertools.count(1000.0)
    monkeypatch.setattr(access, "monotonic", lambda: next(now_s))
    users = access.KnownUsers(file, lambda before, after: None)
    assert users.get("admin") == USERS["admin"]
    for told in (1, 2):  # again after it was well
        file.rename(tmp_path / "aside")
        assert all(users.get("admin") == USERS["admin"] for _ in range(5))
        assert len(caplog.messages) == told
        (tmp_path / "aside").rename(file)
        assert users.get("nobody") is None


def test_what_people_do_stands_in_the_audit_log_without_secrets(
    clients: dict[str, httpx.Client], guarded: RunningPage
) -> None:
    note = "false alarm: a bag"
    closed = {"phase": "close", "reason": "false", "note": note}
    assert clients["operator"].post("/api/events/opened", json=closed).status_code == 200
    setup = guarded.process._setup
    with Ledger(Path(setup.data["ledger"])) as ledger:
        entries = ledger.audit()
        assert ("operator", "close", note) in [
            (entry.who, entry.act, entry.details.get("note")) for entry in entries
        ]
        assert "login" in [entry.act for entry in entries]
        assert ledger.verify_audit().is_whole
        told = repr(entries)
    for secret in (PASSWORD, TOKEN, HASH, clients["operator"].headers["Cookie"]):
        assert secret not in told


def test_no_secret_is_logged(tmp_path: Path) -> None:
    write_users(tmp_path / "users.toml", USERS)
    code = f"""
import httpx
from made_page import SITE
from pathlib import Path
from trecsim.page.address import PageAddress
from trecsim.page.page_process import PageProcess
address = PageAddress(port=0, users_file=Path({str(tmp_path / "users.toml")!r}), token_env="TOKEN")
with PageProcess(address, SITE) as page, httpx.Client(base_url=page.url, timeout=20) as client:
    for password in ({PASSWORD!r}, "wrong-password"):
        client.post("/api/login", json={{"user": "admin", "password": password}})
    for token in ({TOKEN!r}, "wrong-token"):
        client.get("/api/site", headers={{"Authorization": f"Bearer {{token}}"}})
    client.get("/api/site?token=wrong-token")
"""
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "TOKEN": TOKEN},
    )  # fmt: skip
    assert done.stdout == done.stderr == ""


def test_a_file_of_users_is_read_by_its_owner_alone(tmp_path: Path) -> None:
    write_users(tmp_path / "users.toml", USERS)
    assert (tmp_path / "users.toml").stat().st_mode & 0o777 == 0o600
    assert read_users(tmp_path / "users.toml") == USERS


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "expected format"),
        ('format = "trecsim.users/2"', "expected format"),
        ('format = "trecsim.users/1"\n[users.a]\nrole = "boss"\npassword = "x"', "users.a.role"),
        ('format = "trecsim.users/1"\n[users.a]\nrole = "admin"\npassword = "x"', "users.a.pass"),
        ('format = "trecsim.users/1"\n[users.a]\nrole = "admin"', "users.a: expected role and"),
        ('format = "trecsim.users/1"\n[users.token]\nrole = "admin"', "reserved"),
        ('format = "trecsim.users/1"\n[users."a b"]\nrole = "admin"', "user names have"),
        ('format = "trecsim.users/1"\nuser = 1', "and nothing else"),
        ("\x00", "is no file of users"),
    ],
)
def test_a_wrong_file_of_users_is_told_without_what_is_in_it(
    tmp_path: Path, text: str, said: str
) -> None:
    (tmp_path / "users.toml").write_text(text)
    with pytest.raises(InputError, match=said):
        read_users(tmp_path / "users.toml")


def test_a_page_whose_protection_is_missing_does_not_begin(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SHORT", "1234")
    monkeypatch.setenv("TOKEN_OF_ALL", TOKEN)
    (tmp_path / "empty.toml").write_text('format = "trecsim.users/1"\n')
    (tmp_path / "no.pem").write_text("none")
    for address, said in (
        (PageAddress(users_file=tmp_path / "none.toml"), "there is no such file; add somebody"),
        (PageAddress(users_file=tmp_path / "empty.toml"), "it names nobody; add somebody"),
        (PageAddress(token_env="NOT_SET"), "environment variable NOT_SET, found none"),
        (PageAddress(token_env="SHORT"), "at least 16 characters .* found one of 4"),
        (
            PageAddress(feeds_token_env="NOT_SET"),
            "feeds_token_env: .* variable NOT_SET, found none",
        ),
        (
            PageAddress(token_env="TOKEN_OF_ALL", feeds_token_env="TOKEN_OF_ALL"),
            "feeds_token_env: expected a token of its own, found that of token_env",
        ),
        (
            PageAddress("0.0.0.0", feeds_token_env="TOKEN_OF_ALL"),
            "expected users or token_env, found neither",
        ),
        (
            PageAddress(tls_cert=tmp_path / "no.pem", tls_key=tmp_path / "no.pem"),
            "expected a certificate and its key",
        ),
    ):
        with pytest.raises(InputError, match=said):
            address.check()


@pytest.fixture
def certified(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> PageAddress:
    """Return the address of a page that speaks TLS, with a certificate that vouches for itself."""
    if shutil.which("openssl") is None:
        pytest.skip("openssl, which makes the certificate, is not installed")
    cert, key = tmp_path / "cert.pem", tmp_path / "key.pem"
    subprocess.run(
        ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1",
         "-nodes", "-days", "2", "-subj", "/CN=localhost", "-addext",
         "subjectAltName=DNS:localhost,IP:127.0.0.1", "-keyout", key, "-out", cert],
        check=True, capture_output=True,
    )  # fmt: skip
    monkeypatch.setenv("PAGE_TOKEN", TOKEN)
    return PageAddress(port=0, token_env="PAGE_TOKEN", tls_cert=cert, tls_key=key)


def trusting(address: PageAddress) -> ssl.SSLContext:
    return ssl.create_default_context(cafile=str(address.tls_cert))


def test_a_page_with_a_certificate_speaks_tls_and_nothing_else(certified: PageAddress) -> None:
    trust = trusting(certified)
    with (
        PageProcess(certified, SITE) as page,
        httpx.Client(base_url=page.url, verify=trust) as client,
    ):
        assert page.url.startswith("https://127.0.0.1:")
        assert client.get("/", timeout=20).status_code == 200
        given = snapshot(time(), [3])
        page.write(given)
        live = trecsim.connect(page.url, TOKEN, tls=trust)
        assert next(live).id.tolist() == [3]
        with pytest.raises(httpx.TransportError):
            httpx.get(page.url.replace("https", "http"), timeout=20)


def test_a_request_that_comes_with_the_end_of_the_handshake_is_answered(
    certified: PageAddress,
) -> None:
    with PageProcess(certified, SITE) as page:
        port = httpx.URL(page.url).port or 0
        trust = trusting(certified)
        incoming, outgoing = ssl.MemoryBIO(), ssl.MemoryBIO()
        tls = trust.wrap_bio(incoming, outgoing, server_hostname="localhost")
        with socket.create_connection(("127.0.0.1", port), timeout=20) as connection:
            while True:
                try:
                    tls.do_handshake()
                    break
                except ssl.SSLWantReadError:
                    connection.sendall(outgoing.read())
                    incoming.write(connection.recv(65536))
            tls.write(b"GET /api/health HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")
            connection.sendall(outgoing.read())  # the last of the handshake, and the request
            answer = b""
            while b'{"status":' not in answer:
                part = connection.recv(65536)
                assert part, "the page ended the connection without an answer"
                incoming.write(part)
                with suppress(ssl.SSLWantReadError):
                    answer += tls.read(65536)


@linux
def test_connections_that_never_finish_their_handshake_keep_nobody_out(
    certified: PageAddress,
) -> None:
    with PageProcess(certified, SITE) as process, ExitStack() as idle:
        port = httpx.URL(process.url).port or 0
        with httpx.Client(base_url=process.url, verify=trusting(certified), timeout=20) as client:
            assert client.get("/").status_code == 200
            page = process_of(RunningPage(process, client))
            for _ in range(HANDSHAKES + 50):
                idle.enter_context(socket.create_connection(("127.0.0.1", port), timeout=20))
            until(lambda: handles(page) < HANDSHAKES + 40)  # and its own ones
            assert client.get("/api/health").status_code == 503
            assert httpx.get(process.url, verify=trusting(certified)).status_code == 200
        until(lambda: handles(page) < 40)  # all were cut


def handles(process: int) -> int:
    """Return how many files and connections a process holds."""
    return len(list(Path(f"/proc/{process}/fd").iterdir()))
