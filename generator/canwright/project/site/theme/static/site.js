"use strict";
// Links to other languages and editions keep the section; the menu; wide tables; the dialog of the search.
(() => {
  const dialog = document.getElementById("site-search");
  const { root, edition, language, explorer } = dialog.dataset;
  const texts = JSON.parse(dialog.dataset.texts);
  const input = dialog.querySelector("input");
  const list = dialog.querySelector("ul");
  const status = dialog.querySelector("[role=status]");

  for (const link of document.querySelectorAll("[data-keep-anchor]")) {
    link.addEventListener("click", () => {
      link.hash = location.hash;
      try {
        if (link.dataset.keepAnchor) { localStorage.setItem("canwright-language", link.dataset.keepAnchor); }
      } catch { /* without storage, the start page uses the language of the browser */ }
    });
  }

  const current = document.querySelector(".sidebar-tree .current-page");
  const menu = document.querySelector(".sidebar-scroll");
  if (current && menu) { menu.scrollTop += current.getBoundingClientRect().top - menu.getBoundingClientRect().top - menu.clientHeight / 3; }

  // What scrolls can be scrolled with the keyboard.
  for (const wide of document.querySelectorAll("pre, .table-wrapper")) {
    if (wide.scrollWidth > wide.clientWidth || wide.scrollHeight > wide.clientHeight) { wide.tabIndex = 0; }
  }

  window.canwright = {}; // for the script that reads frames, which is that of the frame explorer
  const counted = count => texts.results[new Intl.PluralRules(language).select(count)].replace("{count}", count);

  let ready = null;
  const load = () => {
    ready ??= Promise.all(["frames.js", "search.js", "search-index.js"].map(name => new Promise((resolve, reject) => {
      const script = document.createElement("script");
      script.src = `${root}_static/${name}`;
      script.onload = resolve;
      script.onerror = reject;
      document.head.append(script);
    }))).then(() => createSearch(searchIndex, language));
    return ready;
  };

  const element = (tag, text, properties = {}) => Object.assign(document.createElement(tag), properties, { textContent: text });

  const show = hit => {
    const item = document.createElement("li");
    const link = element("a", "", { href: `${root}${hit.page}.html${hit.anchor ? `#${hit.anchor}` : ""}` });
    if (hit.code) { link.append(element("code", hit.code), " "); }
    link.append(hit.title);
    if (hit.edition) { link.append(" ", element("span", hit.edition, { className: "edition" })); }
    if (hit.detail) { link.append(element("small", hit.detail)); }
    item.append(link);
    for (const other of hit.others) {
      item.append(" ", element("a", other.edition, { className: "other", href: `${root}${other.page}.html${other.anchor ? `#${other.anchor}` : ""}` }));
    }
    return item;
  };

  const update = async () => {
    const search = await load();
    const query = input.value;
    const hits = search(query, edition, texts);
    list.replaceChildren(...hits.map(show));
    const frame = explorer ? pastedFrame(query) : null;
    if (frame) {
      const text = frame.id === null ? query.trim() : canwright.frames.format(frame);
      const item = document.createElement("li");
      item.append(element("a", `${texts.decode} ${text}`, { href: `${root}${explorer}#frame=${encodeURIComponent(text)}` }));
      list.prepend(item);
    }
    const count = hits.length + (frame ? 1 : 0);
    const [, code] = query.trim().match(/^(?:0x)?([0-9a-f]{2})h?$/iu) ?? [];
    status.textContent = count ? counted(count) : code ? texts.no_code.replace("{code}", `0x${code.toUpperCase()}`) : query.trim() && texts.no_results;
  };

  const open = () => {
    if (!dialog.open) { dialog.showModal(); }
    input.focus();
    input.select();
    update();
  };

  document.querySelectorAll("[data-open-search]").forEach(button => button.addEventListener("click", open));
  document.addEventListener("keydown", event => {
    const isTyping = event.target.closest("input, textarea, select, [contenteditable]");
    const isShortcut = (event.key === "/" && !isTyping) || (event.key === "k" && (event.ctrlKey || event.metaKey));
    if (isShortcut && !event.altKey) {
      event.preventDefault();
      open();
    }
  });
  input.addEventListener("input", update);
  dialog.addEventListener("click", event => { if (event.target === dialog) { dialog.close(); } });
  list.addEventListener("click", () => dialog.close());
  dialog.addEventListener("keydown", async event => {
    const links = [...list.querySelectorAll("li > a:first-child")];
    const at = links.indexOf(document.activeElement);
    if (event.key === "ArrowDown" || event.key === "ArrowUp") {
      event.preventDefault();
      const next = at + (event.key === "ArrowDown" ? 1 : -1);
      (links[next] || (next < 0 ? input : document.activeElement)).focus();
    } else if (event.key === "Escape") {
      event.preventDefault();
      dialog.close();
    } else if (event.key === "Enter" && event.target === input && !event.isComposing) {
      event.preventDefault();
      await update();
      list.querySelector("a")?.click();
    }
  });
})();
