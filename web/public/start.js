// Runs before anything is drawn: the theme, so that nothing flashes; the question who is signed in,
// so that the answer is there when the page is; and what is said where the page cannot run. Written
// for any browser.
(function () {
  var root = document.documentElement;
  var kept = null;
  try {
    kept = JSON.parse(localStorage.getItem("trecsim") || "null");
  } catch (error) {
    // nothing is kept here: as the device says
  }
  var theme = kept && kept.theme;
  if (theme !== "light" && theme !== "dark") {
    var dark = window.matchMedia && matchMedia("(prefers-color-scheme: dark)").matches;
    theme = dark ? "dark" : "light";
  }
  root.setAttribute("data-theme", theme);

  if (window.fetch) window.me = fetch("/api/me", { credentials: "same-origin", cache: "no-store" });

  function say(title, line) {
    if (root.getAttribute("data-started") !== null) return;
    var heads = document.getElementsByTagName("h1");
    if (heads.length === 0) return;
    heads[0].textContent = title;
    heads[0].nextElementSibling.textContent = line;
    document.title = title;
    root.setAttribute("data-failed", "");
  }

  function tooOld() {
    say("This browser is too old", "The page needs a browser of 2023 or newer. People are tracked all the same.");
  }

  window.addEventListener("error", function (event) {
    var from = event.target;
    if (from === window) tooOld();
    else if (from && from.tagName === "SCRIPT") say("The page was not loaded", "Load it again.");
  }, true);
  if (!("noModule" in document.createElement("script"))) {
    document.addEventListener("DOMContentLoaded", tooOld);
  }
})();
