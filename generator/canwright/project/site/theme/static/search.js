"use strict";
// Search without an inverted index: some thousand short texts are compared in a few milliseconds. Libraries for full
// text split words at spaces, which Chinese does not have, and know neither codes nor rules of ids.

const SEPARATORS = /[\s_\-‐–—,，、;；:：。()（）[\]【】"'“”`!！?？]+/gu;
const BOUNDARY = /(?<=[\u3400-\u9fff])(?=[a-z0-9])|(?<=[a-z0-9])(?=[\u3400-\u9fff])/gu;
const CHINESE = /[\u3400-\u9fff]/u;

/** How much a match in an item of a kind is worth; exact matches are compared by it, too. */
const WEIGHTS = { command: 1, entry: 0.97, id: 0.95, page: 0.9, effect: 0.75, field: 0.7, value: 0.65, type: 0.6, table: 0.6, erratum: 0.55, parameter: 0.55, setting: 0.5, mode: 0.5, state: 0.5, heading: 0.8 };
const ABOUT = 0.3;
/** Headings of manuals often end with this word, which titles of commands do not contain. */
const COMMAND = ["command", "命令"];
const EXACT = 10;

/** Lower case, with single spaces; also between Chinese and Latin text, which people write with and without one. */
const normalized = text => text.normalize("NFKC").toLowerCase().replace(BOUNDARY, " ").replace(SEPARATORS, " ").trim();

/** How well a text contains a term: 1 for an equal text, 0 for none. */
function quality(term, text) {
  if (term === text) { return 1; }
  const isChinese = CHINESE.test(term);
  if (!text.includes(term)) { return isChinese ? 0.4 * pairsIn(term, text) : 0; }
  const share = term.length / text.length / 10;
  const spaced = ` ${text} `;
  if (isChinese || spaced.includes(` ${term} `)) { return (text.startsWith(term) ? 0.8 : 0.7) + share; }
  if (spaced.includes(` ${term}`)) { return 0.5 + share; }
  return term.length > 2 ? 0.3 + share : 0;
}

/** The share of pairs of neighbouring Chinese characters that a text contains, if it is most of them. */
function pairsIn(term, text) {
  const pairs = [...term].slice(1).map((character, i) => term[i] + character);
  const found = pairs.filter(pair => text.includes(pair)).length / pairs.length;
  return pairs.length > 1 && found >= 0.6 ? found : 0;
}

function createSearch(index, language) {
  const groups = index.synonyms.map(group => group.map(normalized));
  const documents = new Map();
  let order = 0;

  const add = (folder, path, item) => {
    const page = folder ? `${folder}/${path}` : path;
    if (!documents.has(page)) { documents.set(page, { page, path, folder, order: order++, items: [], main: null }); }
    const found = documents.get(page);
    found.items.push(item);
    if (item.kind === "command" || item.kind === "page") { found.main ??= item; }
  };

  const inLanguage = texts => texts ? (texts[language] ?? Object.values(texts)[0] ?? "") : "";

  for (const [page, { title, headings, text }] of Object.entries(index.pages)) {
    const edition = index.editions.find(({ folder }) => page.startsWith(`${folder}/`));
    const path = edition ? page.slice(edition.folder.length + 1) : page;
    add(edition?.folder ?? "", path, { kind: "page", title, texts: [normalized(title)], about: [normalized(text)] });
    for (const [heading, anchor] of headings) {
      add(edition?.folder ?? "", path, { kind: "heading", title: heading, anchor, texts: [normalized(heading)], about: [] });
    }
  }
  for (const edition of index.editions) {
    for (const record of edition.records) {
      const titles = Object.values(record.title ?? {});
      const codes = (record.code ?? "").split(", ").flatMap(code => [code, code.replace(/^0x/, "")]);
      const texts = [record.name, ...codes, ...titles, ...(record.units ?? [])].map(normalized).filter(Boolean);
      const described = [record.about ?? {}, ...(record.notes ?? [])].flatMap(Object.values).map(normalized);
      const about = record.kind === "command" ? [...described, ...COMMAND] : described;
      const item = { ...record, title: inLanguage(record.title), texts: [...new Set(texts)], about };
      for (const place of record.pages ?? []) {
        const [path, anchor] = place.split("#");
        add(edition.folder, path, anchor ? { ...item, anchor } : item);
      }
    }
  }
  const items = [...new Set([...documents.values()].flatMap(found => found.items))];
  const names = new Map(index.editions.map(edition => [edition.folder, edition.name]));
  const families = new Map(index.editions.map(edition => [edition.folder, edition.family]));
  const newest = index.editions.at(-1)?.folder ?? "";

  /** The terms of a query, each with the words that mean the same. */
  function terms(query) {
    const found = [];
    let rest = query;
    while (rest) {
      const starts = groups.flatMap(group => group.filter(word => isStart(word, rest)).map(word => ({ word, group })));
      const longest = Math.max(0, ...starts.map(({ word }) => word.length));
      const end = longest || nextEnd(rest);
      const word = rest.slice(0, end);
      const same = starts.filter(start => start.word.length === longest).flatMap(start => start.group);
      found.push({ word, same: [...new Set(same)].filter(other => other !== word) });
      rest = rest.slice(end).trim();
    }
    return found;
  }

  const isStart = (word, text) => text.startsWith(word) && (CHINESE.test(word) || !text[word.length] || text[word.length] === " " || CHINESE.test(text[word.length]));

  /** Where the first word of a text ends: at a space, or before a Chinese synonym. */
  function nextEnd(text) {
    const space = text.indexOf(" ");
    const end = space < 0 ? text.length : space;
    for (let i = 1; i < end; i++) {
      if (CHINESE.test(text[i]) && groups.some(group => group.some(word => word.length > 1 && text.startsWith(word, i)))) { return i; }
    }
    return end;
  }

  /** The item of an id, with the node that it belongs to; null for another id. */
  function ofId(item, query) {
    const digits = item.ids && query.match(/^(?:0x)?([0-9a-f]{2,8})$/);
    if (!digits) { return null; }
    const { base, step = 0, first = 0, last = 0 } = item.ids;
    const node = step ? (parseInt(digits[1], 16) - base) / step : 0;
    const fits = step ? Number.isInteger(node) && node >= first && node <= last : parseInt(digits[1], 16) === base;
    return fits ? { ...item, node: step ? node : null } : null;
  }

  /** How well an item matches the whole query and each of its terms. */
  function rate(item, query, parts) {
    const weight = WEIGHTS[item.kind];
    const identified = ofId(item, query);
    const values = parts.map(({ word, same }) => {
      let best = 0;
      for (const text of item.texts) {
        best = Math.max(best, quality(word, text), ...same.map(other => 0.8 * quality(other, text)));
      }
      for (const text of best ? [] : item.about) { best = Math.max(best, ABOUT * quality(word, text)); }
      return best * weight;
    });
    const isWhole = identified || item.texts.includes(query);
    const whole = isWhole ? EXACT + (item.kind === "heading" ? 0 : weight) : 0;
    return { item: identified ?? item, values, score: whole || values.reduce((sum, value) => sum + value, 0) / parts.length };
  }

  /** The best item of a page, if the page has it all: an exact match, or one of each term. */
  function match(found, parts, rated) {
    const all = found.items.map(item => rated.get(item));
    const best = all.reduce((one, other) => other.score > one.score ? other : one);
    if (best.score >= EXACT) { return { found, score: best.score, item: best.item }; }
    const perTerm = parts.map((_, i) => Math.max(...all.map(({ values }) => values[i])));
    const score = perTerm.reduce((sum, value) => sum + value, 0) / parts.length;
    return perTerm.every(Boolean) ? { found, score, item: best.item } : null;
  }

  /** The hits of a query, best first; those of `edition` before those of others that match as well. */
  return function search(text, edition, texts) {
    const query = normalized(text);
    if (!query) { return []; }
    const parts = terms(query);
    const rated = new Map(items.map(item => [item, rate(item, query, parts)]));
    const pages = new Map();
    for (const found of documents.values()) {
      const hit = match(found, parts, rated);
      if (hit) {
        const key = `${families.get(found.folder) ?? ""} ${found.path}`;
        pages.set(key, [...(pages.get(key) ?? []), hit]);
      }
    }
    const isCurrent = hit => hit.found.folder === edition;
    const ranked = [...pages.values()].map(hits => {
      const most = Math.max(...hits.map(hit => hit.score));
      const good = hits.filter(hit => hit.score >= most * 0.9);
      const best = good.find(isCurrent) ?? good.find(hit => hit.found.folder === newest) ?? good.at(-1);
      return { best, hits, most, level: Math.floor(Math.min(most, EXACT) * 2), current: isCurrent(best) };
    });
    ranked.sort((a, b) => b.level - a.level || b.current - a.current || b.most - a.most || a.best.found.order - b.best.found.order);
    return ranked.map(({ best, hits }) => shown(best, hits, texts));
  };

  function shown({ found, item }, hits, texts) {
    const main = found.main ?? item;
    const isMain = item === main;
    const node = item.node ? `, ${texts.node.replace("{node}", item.node)}` : "";
    const unit = item.units ? ` [${item.units[0]}]` : "";
    const label = texts.kinds[item.kind] ? `${texts.kinds[item.kind]} ` : "";
    const name = item.name && item.name !== item.title ? `${item.name}: ` : "";
    return {
      page: found.page,
      anchor: isMain ? "" : item.anchor ?? "",
      code: main.code ?? "",
      title: main.title,
      edition: names.get(found.folder) ?? "",
      detail: isMain ? main.name ?? "" : `${label}${name}${item.title}${unit}${node}`,
      others: hits.filter(hit => hit.found !== found).map(hit => ({ page: hit.found.page, anchor: hit.item.anchor ?? "", edition: names.get(hit.found.folder) })),
    };
  }
}
