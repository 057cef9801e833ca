"use strict";
// Search without an inverted index: some thousand short texts are compared in a few milliseconds. Libraries for full
// text split words at spaces, which Chinese does not have, and know neither codes nor rules of ids.

const SEPARATORS = /(?:[\s_+=~±*&|$<>\-‐–—,，、;；:：。()（）[\]{}【】《》"'“”`!！?？/]|\.{2,})+/gu;
const BOUNDARY = /(?<=[\u3400-\u9fff])(?=[a-z0-9])|(?<=[a-z0-9])(?=[\u3400-\u9fff])/gu;
const BETWEEN_CHINESE = /(?<=[\u3400-\u9fff]) (?=[\u3400-\u9fff])/gu;
const CHINESE = /[\u3400-\u9fff]/u;
/** A number directly before its unit, as `0.01rpm`, `500kbps` or `1.5A`, but no hexadecimal number. */
const QUANTITY = /(?<![\w.])(?:\d+\.\d+(?=[a-zµ°℃])|\d+(?=[a-zµ°℃]{1,6}(?!\w))(?![a-fh]\b|x))/giu;

/** The `s` of `limits`, not of `bus`, `loss` or `rps`. */
const PLURAL = /(?<=\b[a-z]{2,}[a-rtv-z])s\b/gu;
/** The ending of `calibrated`, `calibration` or `braking`. */
const ENDING = /(?<=[a-z]{4})(?:ing|ion|ed|e)$/u;
const FORM = /^(?:ing|ion|or|er|ed|e)?(?: |$)/u;

/** Where `maxLevel` has two words, but not `mA`. */
const CAMEL = /(?<=[a-z]{2})(?=[A-Z])/gu;

/** A code or an id as a word of its own. */
const CODE = /^(?:0x[0-9a-f]{2,8}|[0-9a-f]{2,3}h?|[0-9a-f]{8})$/u;
/** The bytes of a frame, which manuals print beside codes and fields. */
const PLACE = /\bdata\s*\[\d+(?:\.\.\d+)?\]/giu;
/** A month as it is written in Chinese. */
const MONTH = /(\d{4})\s*年\s*(\d{1,2})\s*月/gu;
/** What headings of manuals add in parentheses. */
const REMARK = /(?<=\S)\s*[（(][^（()）]{8,}[)）]/gu;

/** How much a match in an item of a kind is worth; exact matches are compared by it, too. */
const WEIGHTS = { command: 1, type: 0.8, entry: 0.9, id: 0.95, page: 0.9, question: 0.9, heading: 0.88, mode: 0.75, effect: 0.7, field: 0.7, value: 0.65, table: 0.6, erratum: 0.45, parameter: 0.55, setting: 0.5, state: 0.5, neighbour: 0.5 };
/** For an item that is the whole query: the type of a field comes before the commands that have it. */
const WHOLE = { heading: 0, type: 0.99, setting: 0.65 };
/** For a question, if the query is one word, which is rather the name of something. */
const ASKED = 0.85;
/** The kinds of items that a query can mean in words of its own. */
const MEANT = new Set(["command", "entry", "type", "mode", "question"]);
/** For a name in the spelling of the manual, or a title as it is printed. */
const PRINTED = 0.3;
/** A field of more commands than these does not lead to them by its name alone. */
const FREQUENT = 4;
const ABOUT = 0.3;
const EXACT = 10;
const SYNONYM = 0.85;
/** For a synonym in the title of a command: manuals use several words for one. */
const TITLED = 0.92;
/** For a page whose items contain the terms, each another one; not for questions, each of which has its own topic. */
const SCATTERED = 0.85;
/** For a page of no edition, if the query names one. */
const BESIDE = 0.9;
/** For an item that has the words of the query side by side. */
const PHRASE = 1.1;
/** Of a query with typos, how many corrections are compared. */
const SPELLINGS = 6;
/** Weight of a word that is in many questions, beside 1 and more for the others. */
const STOP = 0.05;
/** A page whose score is below this share of the best one is no hit. */
const LEAST = 0.2;

/** Lower case and singular, with single spaces; also between Chinese and Latin text, which people write with and without one. */
const normalized = text => text.normalize("NFKC").toLowerCase().replace(BOUNDARY, " ").replace(SEPARATORS, " ").replace(PLURAL, "").replace(/\bthe /gu, "").trim();

/** `maxLevel` as `maxlevel` and `max level`, `over_voltage` as `over voltage` and `overvoltage`. */
const spellings = name => [name, name.replace(CAMEL, " "), name.replace(/(?<=[a-z])[-_](?=[a-z])/giu, "")].map(normalized);

/** The function that states how well a text contains a term: 1 for an equal text, 0 for none. */
const matcher = kept(term => {
  const isChinese = CHINESE.test(term);
  const [stem, separate] = [isChinese ? "" : term.replace(ENDING, ""), isChinese && term.length > 1 ? term : ` ${term} `];
  const pairs = isChinese && !/[a-z0-9]/u.test(term) ? [...term].slice(1).map((character, i) => term[i] + character) : [];
  return text => {
    if (term === text) { return 1; }
    if (!text.includes(stem)) { return 0; }
    const share = term.length / text.length / 10;
    if ((isChinese && term.length > 1 ? text : ` ${text} `).includes(separate)) { return (text.startsWith(term) ? 0.76 : 0.7) + share; }
    if (isChinese) { return 0.6 * shareOf(pairs, text); }
    if (term.length < 3) { return 0; }
    const isPart = ` ${text}`.includes(` ${term}`) || hasForm(` ${text}`, ` ${stem}`);
    return isPart ? 0.5 + share : text.includes(term) ? 0.3 + share : 0;
  };
});

/** Whether a text has a word with a stem and an ending, as `calibrate` for `calibrat`, but not `windows` for `wind`. */
function hasForm(text, stem) {
  for (let at = text.indexOf(stem); at >= 0; at = text.indexOf(stem, at + 1)) {
    if (FORM.test(text.slice(at + stem.length))) { return true; }
  }
  return false;
}

/** The share of pairs of neighbouring Chinese characters that a text contains, if it is most of them. */
function shareOf(pairs, text) {
  const share = pairs.filter(pair => text.includes(pair)).length / pairs.length;
  return pairs.length > 1 && share >= 0.6 ? share : 0;
}

/** The number of inserted, deleted, changed or exchanged letters between two words; more than `most` counts as one more. */
function distance(word, other, most) {
  if (Math.abs(word.length - other.length) > most) { return most + 1; }
  let [before, last] = [[], Array.from({ length: other.length + 1 }, (_, j) => j)];
  for (let i = 1; i <= word.length; i++) {
    const row = [i];
    for (let j = 1; j <= other.length; j++) {
      const changed = last[j - 1] + (word[i - 1] === other[j - 1] ? 0 : 1);
      row[j] = Math.min(last[j] + 1, row[j - 1] + 1, changed);
      if (i > 1 && j > 1 && word[i - 1] === other[j - 2] && word[i - 2] === other[j - 1]) { row[j] = Math.min(row[j], before[j - 2] + 1); }
    }
    [before, last] = [last, row];
  }
  return last[other.length];
}

/** Two or three bytes side by side, which no number looks like. */
const [PAIR, TRIPLE] = [2, 3].map(count => new RegExp(`(?:\\b(?:0?x)?[0-9a-f]{2}h?(?:[^\\w\\u3000-\\u9fff]{1,3}|$)){${count}}`, "iu"));

/** The frame that a query is, in any notation that the frame explorer reads; null for a query that can be words or numbers. */
function pastedFrame(text) {
  const { frame } = canwright.frames.parse(text);
  const plain = text.normalize("NFKC");
  const least = text.includes("#") ? 0 : frame?.id != null ? (PAIR.test(plain) ? 2 : 4) : (TRIPLE.test(plain) ? 3 : 8);
  return frame && frame.data.length >= least ? frame : null;
}

/** A function of a text that computes each result once. */
function kept(compute) {
  const results = new Map();
  return (text, ...rest) => {
    if (!results.has(text)) { results.set(text, compute(text, ...rest)); }
    return results.get(text);
  };
}

function createSearch(index, language) {
  const groups = index.synonyms.map(group => group.map(normalized));
  const synonyms = new Map(); // by the first character
  for (const group of groups) {
    for (const word of group) { synonyms.set(word[0], [...(synonyms.get(word[0]) ?? []), { word, group }]); }
  }
  const stops = new Set(index.stops.map(normalized));
  const labels = groups.filter(group => group.includes("command") || group.includes("send")).flat().flatMap(text => text.split(" "));
  const documents = new Map();
  let order = 0;

  const add = (folder, path, item) => {
    const page = folder ? `${folder}/${path}` : path;
    if (!documents.has(page)) { documents.set(page, { page, path, folder, order: order++, items: [], main: null }); }
    const of = documents.get(page);
    of.items.push(item);
    if (item.kind === "command" || item.kind === "page") { of.main ??= item; }
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
  for (const { folder, records } of [{ folder: "", records: index.questions }, ...index.editions]) {
    for (const record of records) {
      const codes = (record.code ?? "").split(", ").flatMap(code => [code, code.replace(/^0x(?!\d\d$)/, ""), code.replace(/^0x(\w+)$/, "$1h")]);
      const rule = record.ids ? [record.name.replace(/^0x/, "")] : [];
      const words = [record.name, ...rule, ...(record.printed ?? "").split(", "), ...Object.values(record.title ?? {}), ...(record.words ?? [])].flatMap(spellings);
      const texts = [...words, ...[...codes, ...(record.units ?? [])].map(normalized)].filter(Boolean);
      const about = [record.about ?? {}, ...(record.notes ?? [])].flatMap(Object.values).map(normalized);
      const isEverywhere = record.kind === "field" && new Set(record.pages.map(place => place.split("#")[0])).size > FREQUENT;
      const item = { ...record, title: inLanguage(record.title), texts: [...new Set(texts)], about, isEverywhere };
      for (const place of record.pages ?? []) {
        const [path, anchor] = place.split("#");
        add(folder, path, anchor ? { ...item, anchor } : item);
      }
    }
  }
  const isRepeated = (item, own) => item.kind === "heading" && own.some(({ kind, texts }) => kind !== "heading" && texts.includes(item.texts[0]));
  for (const found of documents.values()) { found.items = found.items.filter(item => !isRepeated(item, found.items)); }
  const items = [...new Set([...documents.values()].flatMap(({ items: own }) => own))];
  const words = new Set([...groups.flat(), ...items.flatMap(({ texts, about }) => [...texts, ...about])].flatMap(text => text.split(" ")));
  const chinese = [...new Set(items.flatMap(({ texts }) => texts).filter(text => CHINESE.test(text)))];
  const vocabulary = new Set([...words].filter(word => /^[a-z]{4,}$/u.test(word)));
  const printed = new Set(items.flatMap(item => (item.printed ?? "").split(", ")).filter(name => /^[a-z]\w+$/iu.test(name)).map(normalized));
  const names = new Map(index.editions.map(edition => [edition.folder, edition.name]));
  const families = new Map(index.editions.map(edition => [edition.folder, edition.family]));
  const folders = [...names.keys()];
  const newest = folders.at(-1) ?? "";

  /**
   * The words that name editions, the longest first: `v2.35 2024 02`, its beginnings, also without `v`, and the month or year of its date.
   * A version is also that of later editions with the same number, which can have what the first one lacks.
   */
  const versions = new Map();
  for (const { folder, name, date } of index.editions) {
    const label = normalized(name).split(" ");
    const beginnings = words => words.map((_, i) => words.slice(0, i + 1).join(" "));
    const all = [...beginnings(label), ...beginnings(label.slice(1)), ...beginnings([label[0].replace(/^v/u, ""), ...label.slice(1)]), ...beginnings(date.split("-").slice(0, 2))];
    for (const text of new Set(all)) {
      if (/\d.*\d/u.test(text) && text.length > 2) { versions.set(text, [...(versions.get(text) ?? []), folder]); }
    }
    for (const text of [label.join(" "), label.join(" ").replace(/^v/u, "")]) { versions.get(text)?.unshift(folder); }
  }
  const byLength = [...versions].sort(([a], [b]) => b.length - a.length);

  /** The editions that a query names, those that all its versions name if there are any, and the rest of it. */
  function ofEditions(query) {
    let rest = ` ${query} `;
    const named = [];
    for (const [text, folders] of byLength) {
      if (rest.includes(` ${text} `)) {
        named.push(folders);
        rest = rest.replaceAll(` ${text} `, " ");
      }
    }
    const common = named.reduce((all, folders) => all.filter(folder => folders.includes(folder)), named[0] ?? []);
    const folders = common.length ? [...new Set(common)] : [...new Set(named.flat())];
    const isExact = folders.length === 1 || common.length > folders.length;
    return { folders, means: isExact ? folders[0] : "", rest: rest.replace(/ +/gu, " ").trim() };
  }

  /** The terms of a query, each with the words that mean the same. */
  function terms(query) {
    const list = [];
    let rest = query;
    while (rest) {
      const starts = (synonyms.get(rest[0]) ?? []).filter(({ word }) => isStart(word, rest));
      const longest = Math.max(0, ...starts.map(({ word }) => word.length));
      const end = longest || nextEnd(rest);
      const word = rest.slice(0, end);
      const same = starts.filter(start => start.word.length === longest).flatMap(start => start.group);
      list.push({ word, same: [...new Set(same)].filter(synonym => synonym !== word) });
      rest = rest.slice(end).trim();
    }
    return list;
  }

  /** What a text says, the same for synonyms in any order: one word for each term. */
  const meaning = kept(text => terms(text).map(({ word, same }) => [word, ...same].sort()[0]).sort().join(" "));

  const isStart = (word, text) => text.startsWith(word) && (CHINESE.test(word) || !text[word.length] || text[word.length] === " " || CHINESE.test(text[word.length]));

  /** Where the first word of a text ends: at a space, or before and after a Chinese synonym or stop word. */
  function nextEnd(text) {
    const space = text.indexOf(" ");
    const end = space < 0 ? text.length : space;
    if (!CHINESE.test(text[0])) { return end; }
    const stop = [...stops].filter(word => CHINESE.test(word) && text.startsWith(word)).sort((a, b) => b.length - a.length)[0];
    if (stop) { return stop.length; }
    for (let i = 1; i < end; i++) {
      const starts = word => CHINESE.test(word) && text.startsWith(word, i);
      if ([...stops].some(starts) || (synonyms.get(text[i]) ?? []).some(({ word }) => word.length > 1 && starts(word))) { return i; }
    }
    return end;
  }

  /** Chinese words as long as a term or longer by a character: synonyms, and parts of titles for terms of three and more. */
  function neighbours(term) {
    const parts = chinese.flatMap(text => [0, 1].flatMap(more => [...text].map((_, i) => text.slice(i, i + term.length + more))));
    return new Set([...groups.flat().filter(word => word[0] === term[0] || word.at(-1) === term.at(-1)), ...(term.length > 2 ? parts : [])].filter(word => word.length >= term.length && CHINESE.test(word)));
  }

  /** The words of the pages that differ least from a word with a typo; of `32a`, the number and its unit. */
  const near = kept(word => {
    const quantity = word.match(/^(\d+)([a-z])$/u);
    if (quantity) { return [`${quantity[1]} ${quantity[2]}`]; }
    const most = word.length > 8 ? 3 : word.length > 7 ? 2 : 1;
    const isChinese = CHINESE.test(word) && word.length > 1;
    if (!isChinese && !/^[a-z]{3,}$/u.test(word)) { return []; }
    const candidates = [...(isChinese ? neighbours(word) : vocabulary)].map(text => ({ text, far: distance(word, text, most) }));
    const least = Math.min(most, ...candidates.map(({ far }) => far));
    return candidates.filter(({ far }) => far === least).map(({ text }) => text);
  });

  /** How well each item matches a term, which several spellings of a query have. */
  const valuesOf = kept((word, same) => items.map(item => value(item, word, matcher(word), same.map(matcher))));
  const isUnknown = ({ word, same }) => !stops.has(word) && !valuesOf(word, same).some(Boolean);

  /** Whether a term can have a typo: no text contains it, or all only as a part of another word. */
  const isDoubtful = part => isUnknown(part) || (/^[a-z]{3,}$/u.test(part.word) && !part.same.length && !stops.has(part.word) && !words.has(part.word));

  /** Chinese text that no text contains, as the longest parts of it that texts contain and what is between them. */
  function pieces(text) {
    const isIn = part => items.some(({ texts }) => texts.some(of => of.includes(part))) || groups.some(group => group.includes(part));
    const list = [];
    let rest = "";
    for (let at = 0, end = text.length; at < text.length; at = end, end = text.length) {
      while (end - at > 1 && !isIn(text.slice(at, end))) { end--; }
      if (end - at > 1) {
        list.push(rest, text.slice(at, end));
        rest = "";
      } else {
        rest += text.slice(at, end);
      }
    }
    return [...list, rest].filter(part => part.length > 1);
  }

  /** A query, and with the words of the pages instead of words that can have typos, in each way that is probable. */
  function spelled(query) {
    const divided = part => CHINESE.test(part.word) && isUnknown(part) && !near(part.word).length ? pieces(part.word).flatMap(terms) : [part];
    const parts = terms(query).flatMap(divided);
    if (!parts.some(isDoubtful)) { return [query]; }
    return parts.reduce((queries, part) => {
      const alternatives = isDoubtful(part) ? near(part.word) : [];
      return queries.flatMap(each => [part.word, ...alternatives].map(word => `${each} ${word}`)).slice(0, SPELLINGS);
    }, [""]).map(each => each.trim().replace(BETWEEN_CHINESE, ""));
  }

  /** The item of an id, with the node that it belongs to; null for another id. */
  function ofId(item, query) {
    const digits = item.ids && query.match(/^(?:0x|(?!\d\d$))([0-9a-f]{2,8})h?$/u);
    if (!digits) { return null; }
    const { base, step = 0, first = 0, last = 0 } = item.ids;
    const node = step ? (parseInt(digits[1], 16) - base) / step : 0;
    const fits = step ? Number.isInteger(node) && node >= first && node <= last : parseInt(digits[1], 16) === base;
    return fits ? { ...item, node: step ? node : null } : null;
  }

  /** How well an item matches a term, or one of its synonyms. */
  function value(item, word, match, ofSynonyms) {
    let best = ofId(item, word) ? 1 : 0;
    const inTitle = item.kind === "command" ? TITLED : SYNONYM;
    for (const text of item.texts) { best = Math.max(best, match(text), ...ofSynonyms.map(of => inTitle * of(text))); }
    for (const text of best ? [] : item.about) { best = Math.max(best, ABOUT * match(text), ...ofSynonyms.map(of => ABOUT * SYNONYM * of(text))); }
    return best * WEIGHTS[item.kind];
  }

  /** The score of an item that is what the whole query says; 0 for any other. `asked` is the query as typed. */
  function whole(item, query, asked) {
    if (!query || ["question", "effect"].includes(item.kind)) { return 0; }
    if (item.isEverywhere) { return item.texts.includes(query) ? WEIGHTS[item.kind] : 0; }
    if (!ofId(item, query) && !item.texts.includes(query)) {
      const means = meaning(query);
      const isSame = (item.kind === "type" || means.includes(" ")) && MEANT.has(item.kind) && item.texts.some(text => meaning(text) === means);
      return !isSame ? 0 : item.kind === "type" ? EXACT + WHOLE.type : 1 + (WHOLE[item.kind] ?? WEIGHTS[item.kind]);
    }
    const isPrinted = [...(item.printed ?? "").split(", "), item.title.split(/\s*[（(]/u)[0]].includes(asked.trim());
    return EXACT + (WHOLE[item.kind] ?? WEIGHTS[item.kind]) + (isPrinted ? PRINTED : 0);
  }

  /** How well each item matches each term. */
  function valued(parts) {
    const ofParts = parts.map(({ word, same }) => valuesOf(word, same));
    return new Map(items.map((item, i) => [item, ofParts.map(of => of[i])]));
  }

  /** The terms of a query with the values of all items; Chinese terms that nothing contains are divided. */
  function matched(query) {
    const parts = terms(query).flatMap(part => CHINESE.test(part.word) && isUnknown(part) ? pieces(part.word).flatMap(terms) : [part]);
    return { parts, values: valued(parts) };
  }

  /** Pages with their scores: the mean over the terms, in which a term weighs more if it is rare and matches well somewhere. */
  function scored(query, asked) {
    const text = normalized(asked);
    const { parts, values } = matched(query);
    const content = parts.map(({ word }) => word).filter(word => !stops.has(word)).join(" ").replace(BETWEEN_CHINESE, "");
    const hasPhrase = item => parts.length > 1 && item.texts.some(of => ` ${of} `.includes(CHINESE.test(content) ? content : ` ${content} `));
    const pages = [...documents.values()];
    const ofPage = pages.map(page => parts.map((_, i) => Math.max(...page.items.map(item => values.get(item)[i]))));
    const weights = parts.map(({ word }, i) => {
      const frequency = ofPage.filter(of => of[i]).length;
      return !frequency ? 0 : stops.has(word) ? STOP : Math.max(...ofPage.map(of => of[i])) * Math.log(1 + pages.length / frequency);
    });
    const sum = weights.reduce((total, weight) => total + weight, 0) || 1;
    const count = parts.filter(({ word }) => !stops.has(word)).length || 1;
    const mean = of => {
      const share = of.filter((value, i) => value && weights[i] > STOP).length / count; // of words that nothing contains, too
      return of.reduce((total, value, i) => total + weights[i] * value, 0) / sum * (0.7 + 0.3 * share);
    };
    return pages.map((found, n) => {
      const of = found.items.map(item => ({ item, score: [query, text, content].map(each => whole(item, each, asked)).find(Boolean) ?? mean(values.get(item)) * (hasPhrase(item) ? PHRASE : 1) * (parts.length === 1 && item.kind === "question" ? ASKED : 1) }));
      const best = of.reduce((one, two) => two.score > one.score ? two : one);
      return { found, item: ofId(best.item, query) ?? best.item, score: best.item.kind === "question" ? best.score : Math.max(best.score, SCATTERED * mean(ofPage[n])) };
    });
  }

  /**
   * A query with `0x` before two digits that are a code: alone, or beside a word for codes. Other digits are a number.
   * Of words around nothing but codes, only the codes remain; a single letter can be a unit.
   */
  function coded(query) {
    const all = query.split(" ");
    const isStop = word => CHINESE.test(word) ? terms(word).every(term => stops.has(term.word)) : word.length > 1 && stops.has(word);
    const isOnly = !groups.some(group => group.includes(query)) && all.every(word => CODE.test(word) || isStop(word));
    const isBeside = (word, isAt) => labels.some(label => word === label || (CHINESE.test(label) && word?.[isAt](label)));
    const isCode = i => isOnly || isBeside(all[i - 1], "endsWith") || isBeside(all[i + 1], "startsWith");
    const words = all.map((word, i) => /^\d\d$/u.test(word) && isCode(i) ? `0x${word}` : word.replace(/^(0x\w+)h$/u, "$1"));
    return (isOnly && !all.every(isStop) ? words.filter(word => !isStop(word)) : words).join(" ");
  }

  /** The query without what people paste around it: a frame is its code, `A1h` is `a1`, `0.01rpm` two words. */
  function simplified(text) {
    const frame = pastedFrame(text);
    if (frame?.data.length) {
      const code = `0x${canwright.frames.hex(frame.data[0], 2).toLowerCase()}`;
      return frame.id === null || items.some(({ texts }) => texts.includes(code)) ? code : `0x${canwright.frames.hex(frame.id, 3).toLowerCase()}`;
    }
    const words = text.replace(MONTH, (_, year, month) => ` ${year} ${month.padStart(2, "0")} `).replace(PLACE, " ").replace(/[a-z]\w*/giu, name => printed.has(normalized(name)) ? name : name.replace(CAMEL, " "));
    return normalized(words.replace(QUANTITY, "$& "));
  }

  /** The hits of a query, best first; those of `edition` before those of others that match as well. */
  return function search(text, edition, texts) {
    const { folders: asked, means, rest } = ofEditions(simplified(text));
    const query = coded(rest);
    const heading = coded(ofEditions(simplified(text.replace(REMARK, " "))).rest);
    const preferred = means || edition;
    if (!query && !asked.length) { return []; }
    const isOf = folder => !asked.length || asked.includes(folder);
    const all = query ? [...new Set([query, heading].flatMap(spelled))].flatMap(each => scored(each, text)) : [...documents.values()].map(found => ({ found, item: found.main ?? found.items[0], score: found.path === "index" && found.folder ? 1 : 0 }));
    const ofPage = new Map(); // with other spellings, a page is found several times
    for (const hit of all.filter(({ found }) => isOf(found.folder) || (query && !found.folder))) {
      if (!(ofPage.get(hit.found)?.score >= hit.score)) { ofPage.set(hit.found, hit); }
    }
    const own = [...ofPage.values()].map(hit => asked.length && !hit.found.folder ? { ...hit, score: hit.score * BESIDE } : hit).sort((a, b) => folders.indexOf(a.found.folder) - folders.indexOf(b.found.folder));
    const most = Math.max(0, ...own.map(({ score }) => score));
    const pages = new Map();
    for (const hit of own.filter(({ score }) => score > Math.min(most, 1) * LEAST)) {
      const key = `${families.get(hit.found.folder) ?? ""} ${hit.found.path}`;
      pages.set(key, [...(pages.get(key) ?? []), hit]);
    }
    const isCurrent = hit => hit.found.folder === preferred;
    const ranked = [...pages.values()].map(hits => {
      const top = Math.max(...hits.map(hit => hit.score));
      const good = hits.filter(hit => hit.score >= top * 0.9);
      const best = good.find(isCurrent) ?? good.find(hit => hit.found.folder === newest) ?? good.at(-1);
      return { best, hits, top, level: Math.floor(Math.min(top, EXACT) * 5), current: asked.includes(best.found.folder) || (preferred !== "" && isCurrent(best)) };
    });
    const isNewest = ({ best }) => best.found.folder === newest;
    ranked.sort((a, b) => b.level - a.level || b.current - a.current || b.top - a.top || isNewest(b) - isNewest(a) || a.best.found.order - b.best.found.order);
    return ranked.map(({ best, hits }) => shown(best, hits, texts));
  };

  function shown({ found, item }, hits, texts) {
    const main = found.main ?? item;
    const isMain = item === main;
    const isOfCommand = main.kind === "command";
    const node = item.node ? `, ${texts.node.replace("{node}", item.node)}` : "";
    const unit = item.units ? ` [${item.units[0]}]` : "";
    const label = texts.kinds[item.kind] ? `${texts.kinds[item.kind]} ` : "";
    const name = item.name && item.name !== item.title ? item.name : "";
    const printed = item.printed ? ` (${item.printed})` : "";
    const part = isOfCommand ? [name, item.title].filter(Boolean).join(": ") : name;
    return {
      page: found.page,
      anchor: isMain ? "" : item.anchor ?? "",
      code: main.code ?? "",
      title: isOfCommand ? main.title : item.title,
      edition: names.get(found.folder) ?? "",
      detail: (isMain ? main.name ?? "" : `${isOfCommand ? "" : `${main.title} · `}${label}${part}${unit}${node}`.replace(/ · $/u, "")) + printed,
      others: hits.filter(hit => hit.found !== found).flatMap(hit => {
        const same = isMain ? hit.found.main : hit.found.items.find(each => each.kind === item.kind && each.name === item.name && each.title === item.title);
        const link = { page: hit.found.page, anchor: isMain ? "" : same?.anchor ?? "", edition: names.get(hit.found.folder) };
        return same || isOfCommand ? [link] : [];
      }),
    };
  }
}
