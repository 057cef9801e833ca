"use strict";

/** The page: reads the input and the state of the address, shows messages, bits, fields and code. Texts are only set as text. */
(() => {
  const { frames, meaning, code } = canwright;
  const PAGE = 100; // frames of a log that are shown at once
  const GROUP = 5; // of them, between which the page answers
  const PART = 2 ** 14; // bytes of a log that are read at once
  const NAMES = ["frame", "edition", "direction", "command", "compare", "lang"]; // in the address, beside the parameters
  const PREFIX = "parameter."; // of the parameters in the address, so that they can have these names too
  const state = { frame: "", edition: "", direction: "", command: "", compare: "", lang: "", parameters: {} };
  let interpretations = [];
  let chosen = null;
  let field = "";
  let log = { frames: [], start: 0 };
  let listing = { basis: "" }; // what the rows of the log depend on; another object for each listing

  const at = (id) => document.getElementById(id);

  /** An element with properties; `children` are elements and texts. */
  function make(tag, properties = {}, ...children) {
    const { dataset = {}, ...attributes } = properties;
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) {
      if (name in element) {
        element[name] = value;
      } else {
        element.setAttribute(name, value);
      }
    }
    Object.assign(element.dataset, dataset);
    element.append(...children);
    return element;
  }

  function say(key, ...values) {
    const text = canwright.labels[state.lang][key];
    return values.reduce((whole, value, i) => whole.replace(`{${i}}`, () => value), text);
  }

  /** A text of the spec in the language of the page, otherwise in another one. */
  function text(texts, otherwise = "") {
    return texts?.[state.lang] ?? texts?.en ?? Object.values(texts ?? {})[0] ?? otherwise;
  }

  function parameterTitle(edition, name) {
    return text(edition.texts.parameters[name]?.title, name);
  }

  function titleOf({ edition, decoded }) {
    const { code: number, title } = edition.texts.commands[decoded.command];
    const shown = text(title, decoded.command);
    return number === undefined ? shown : `0x${frames.hex(number, 2)} ${shown}`;
  }

  // The state in the address

  function readAddress() {
    const given = new URLSearchParams(location.hash.slice(1));
    const query = new URLSearchParams(location.search);
    const lang = given.get("lang") ?? query.get("lang") ?? (state.lang || navigator.language);
    for (const name of NAMES) {
      state[name] = given.get(name) ?? "";
    }
    state.lang = lang.toLowerCase().startsWith("zh") ? "zh" : "en";
    // old addresses have no prefix
    const valueOf = (name) => given.get(`${PREFIX}${name}`) ?? (NAMES.includes(name) ? null : given.get(name));
    const values = meaning.parameters().map(({ name }) => [name, valueOf(name) ?? ""]);
    state.parameters = Object.fromEntries(values.filter(([, value]) => value !== ""));
  }

  function writeAddress() {
    const entries = NAMES.map((name) => [name, state[name]]);
    entries.push(...Object.entries(state.parameters).map(([name, value]) => [`${PREFIX}${name}`, value]));
    history.replaceState(null, "", `#${new URLSearchParams(entries.filter(([, value]) => value !== ""))}`);
  }

  // Input

  function showParameters() {
    const items = meaning.parameters().map(({ name, values, texts }) => {
      const id = `${PREFIX}${name}`;
      const options = (values ?? []).map((value) => make("option", { value }, text(texts?.values?.[value], value)));
      const unknown = make("option", { value: "" }, say("unknown"));
      const input = values ? make("select", { id }, unknown, ...options) : make("input", { id, inputMode: "decimal", size: 6 });
      input.value = state.parameters[name] ?? "";
      input.addEventListener("change", () => {
        state.parameters[name] = input.value.trim();
        update();
      });
      return make("p", {}, make("label", { htmlFor: id }, text(texts?.title, name)), input);
    });
    at("parameters").replaceChildren(...items);
    at("parameters-box").hidden = !items.length;
  }

  /** Marks the parameters that are valid in no edition; they are ignored. */
  function showInvalid() {
    const names = meaning.invalid(Object.fromEntries(Object.entries(state.parameters).filter(([, value]) => value !== "")));
    const problems = meaning.parameters().map(({ name, texts }) => {
      at(`${PREFIX}${name}`).setAttribute("aria-invalid", String(names.includes(name)));
      return names.includes(name) ? say("invalid", text(texts?.title, name), state.parameters[name]) : "";
    });
    at("parameter-problem").textContent = problems.join(" ").trim();
  }

  function showCommands() {
    const edition = meaning.find(state.edition) ?? chosen?.edition ?? meaning.editions[0];
    at("edition").replaceChildren(
      ...meaning.editions.map((item) => make("option", { value: meaning.label(item), selected: item === edition }, meaning.label(item))),
    );
    const options = [...edition.messages].map(([value, { direction, command }]) => {
      const title = titleOf({ edition, decoded: { command } });
      return make("option", { value }, `${title} · ${say(direction)}`);
    });
    at("message").replaceChildren(make("option", { value: "" }, say("choose")), ...options);
    at("message").value = chosen && chosen.edition === edition ? `${chosen.decoded.direction} ${chosen.decoded.command}` : "";
  }

  function compose() {
    const [direction, command] = at("message").value.split(" ");
    const edition = meaning.find(at("edition").value);
    state.edition = meaning.label(edition);
    if (direction) {
      Object.assign(state, { direction, command });
      Object.assign(state.parameters, meaning.needed(edition, direction, command, state.parameters));
      showParameters();
      use(meaning.blank(edition, direction, command, state.parameters));
    } else {
      state.command = "";
      update();
    }
  }

  /** Shows a frame that was composed. */
  function use(frame) {
    state.frame = frames.format(frame);
    update();
  }

  /** Shows what a text can mean, the most probable message first. */
  function take(given) {
    Object.assign(state, { frame: given, direction: "", command: "" });
    update();
  }

  /** Lets the page answer. */
  function pause() {
    return new Promise((resolve) => setTimeout(resolve));
  }

  /** Reads a log in parts, between which the page answers. The file that was opened last is shown. */
  async function openLog(file, parseOne = frames.parseLine) {
    const opened = { frames: [], marks: new Set(), skipped: 0, errors: 0, start: 0, name: file.name, percent: 0 };
    const decoder = new TextDecoder();
    let rest = "";
    log = opened;
    for (let end = PART; opened.percent < 100; end += PART) {
      const bytes = await file.slice(end - PART, end).arrayBuffer();
      if (log !== opened) {
        return;
      }
      opened.percent = end < file.size ? Math.floor((100 * end) / file.size) : 100;
      const lines = (rest + decoder.decode(bytes, { stream: end < file.size })).split(/\r?\n/);
      rest = end < file.size ? lines.pop() : "";
      const before = opened.frames.length;
      const parseRow = end === PART && frames.tableParser(lines[0] ?? "");
      if (parseRow) {
        parseOne = parseRow;
        lines.shift();
      }
      frames.parseLines(lines, opened, parseOne);
      if (before < PAGE || opened.percent === 100) {
        showLog(); // the rows of a page stay as they are
      } else {
        showProgress();
      }
      const isFirst = before === 0 && opened.frames.length > 0;
      if (isFirst || (opened.percent === 100 && !opened.frames.length)) {
        await pause();
        if (log === opened) {
          take(isFirst ? frames.withMark(marked(opened.frames[0])) : "");
        }
      }
    }
  }

  /** Shows lines that were pasted: a log, or else one frame on several lines, such as a list of C. */
  function openText(content) {
    const lines = content.trim().split(/\r?\n/);
    const isRefused = () => !/[{[]/.test(content) && frames.parse(lines.join(" ")).problem;
    if (lines.length > 1 && (frames.tableParser(lines[0]) || lines.some(frames.parsePasted) || isRefused())) {
      openLog(new File([content.trim()], say("clipboard")), frames.parsePasted);
    } else {
      take(lines.join(" "));
    }
  }

  function showProgress() {
    const { frames: all, skipped, errors, start, name, percent } = log;
    const isOther = percent === 100 && !all.length && !errors;
    const progress = percent < 100 ? ` ${say("log_read", percent)}` : "";
    const counts = say("log_summary", name, all.length, skipped) + (errors ? say("log_errors", errors) : "");
    at("log-summary").textContent = isOther ? say("case", name, say("other_log")) : counts + progress;
    at("log-summary").className = isOther ? "problem" : "note";
    at("log-table").hidden = isOther;
    at("log-position").textContent = all.length ? `${start + 1}–${Math.min(start + PAGE, all.length)} / ${all.length}` : "";
    at("log-previous").disabled = start === 0;
    at("log-next").disabled = start + PAGE >= all.length;
  }

  function showLog() {
    at("log").hidden = !log.name;
    at("log-rows").replaceChildren();
    if (log.name) {
      showProgress();
      showRows();
    }
  }

  /** Lists the frames of a page in groups, between which the page answers, until they are listed again. */
  async function showRows() {
    const shown = log.frames.slice(log.start, log.start + PAGE);
    const current = { basis: basis() };
    at("log-table").classList.toggle("unmarked", shown.every(({ sent }) => sent === null));
    listing = current;
    for (let i = 0; i < shown.length; i += GROUP) {
      await pause();
      if (listing !== current) {
        return;
      }
      const rows = [...at("log-rows").rows].slice(i, i + GROUP);
      const again = shown.slice(i, i + GROUP).map(row);
      again.forEach((made, k) => (rows[k] ? rows[k].replaceWith(made) : at("log-rows").append(made)));
    }
  }

  /** What the most probable message of a frame depends on. */
  function basis() {
    return JSON.stringify([state.edition, state.parameters]);
  }

  /** A frame with the mark of the recorder, which decides nothing in a log where every frame is received. */
  function marked(frame) {
    return log.marks.has(true) ? frame : { ...frame, sent: null };
  }

  function row(frame) {
    const [best] = meaning.interpret(marked(frame), state.parameters, state.edition);
    const button = make("button", { type: "button" }, frames.format(frame));
    button.addEventListener("click", () => take(frames.withMark(marked(frame))));
    const mark = frame.sent === null ? "" : say(frame.sent ? "sent" : "received");
    const [neighbour] = meaning.neighbours(frame);
    const what = best ? `${titleOf(best)} · ${say(best.decoded.direction)}` : text(neighbour?.title, say("no_message"));
    const cells = [frame.time, mark, button, what, best ? summary(best) : ""];
    return make("tr", {}, ...cells.map((content) => make("td", {}, content)));
  }

  function turn(step) {
    log.start += step * PAGE;
    showLog();
  }

  // Messages

  function isPreferred({ edition, decoded }) {
    const { direction, command, edition: name } = state;
    return (
      (!name || name === meaning.label(edition) || name === edition.name) &&
      (!direction || direction === decoded.direction) &&
      (!command || command === decoded.command)
    );
  }

  function update() {
    const { frame = null, problem = null } = state.frame.trim() ? frames.parse(state.frame) : {};
    interpretations = frame ? meaning.interpret(frame, state.parameters, state.edition) : [];
    chosen = interpretations.find(isPreferred) ?? interpretations[0] ?? null;
    showInvalid();
    at("problem").textContent = problem ? explained(problem) : frame && !interpretations.length ? reasons(frame) : "";
    at("frame").setAttribute("aria-invalid", String(problem !== null));
    at("no-id").hidden = frame === null || frame.id !== null;
    show();
  }

  /** What is wrong in the text, with its column. */
  function explained([label, column, ...values]) {
    return column === undefined ? say(label) : say("column", column, say(label, ...values));
  }

  /** Why no message fits: a line for each reason, with the editions that give it, as the command line does. */
  function reasons(frame) {
    const edition = meaning.find(state.edition);
    const refused = frame.id === null ? [] : meaning.reasons(frame, edition);
    const whose = meaning.neighbours(frame, edition).map(({ title, labels }) =>
      say("neighbour", frames.format(frame).split("#")[0], text(title), labels.join(say("listed"))),
    );
    const short = frame.extended && frame.id <= 0x7ff ? [say("long_id", `0x${frames.hex(frame.id, 8)}`, frames.format({ ...frame, extended: false }))] : [];
    const given = (value) => [value].flat().join(say("or"));
    const reason = ({ direction, refusal, values, labels }) => say("reason", say(direction), say(refusal, say(direction), ...values.map(given)), labels.join(say("listed")));
    return [say("no_message"), ...whose, ...short, ...refused.map(reason)].join("\n");
  }

  function select(interpretation) {
    chosen = interpretation;
    Object.assign(state, { edition: meaning.label(interpretation.edition), direction: interpretation.decoded.direction, command: interpretation.decoded.command });
    show();
    at("found").querySelector('[aria-pressed="true"]')?.focus();
  }

  function show() {
    writeAddress();
    if (log.frames.length && listing.basis !== basis()) {
      showRows();
    }
    showFound();
    showCommands();
    at("chosen").hidden = !chosen;
    if (chosen) {
      const names = chosen.decoded.fields.map(({ name }) => name);
      field = names.includes(field) ? field : "";
      showChosen();
      showBits();
      showFields();
      showComparison();
      showCode();
    }
    at("frame").value = state.frame;
  }

  function showFound() {
    at("found-box").hidden = !interpretations.length;
    at("found-count").textContent = interpretations.length ? say("found_count", interpretations.length) : "";
    const items = interpretations.map((interpretation) => {
      const { edition, decoded, variant, deviation } = interpretation;
      const facts = [say(decoded.direction), meaning.label(edition)];
      if (variant) {
        facts.push(`${parameterTitle(edition, variant.parameter)}: ${variant.values.join(", ")}`);
      }
      if (decoded.node !== null) {
        facts.push(say("node", decoded.node));
      }
      if (deviation) {
        facts.push(say(deviation));
      }
      const button = make(
        "button",
        { type: "button", "aria-pressed": String(interpretation === chosen) },
        make("strong", {}, titleOf(interpretation)),
        make("span", {}, facts.join(" · ")),
        make("small", {}, summary(interpretation)),
      );
      button.addEventListener("click", () => select(interpretation));
      return make("li", {}, button);
    });
    at("found").replaceChildren(...items);
    const current = items[interpretations.indexOf(chosen)];
    if (current) {
      at("found").scrollTop = current.offsetTop - at("found").offsetTop - 8;
    }
  }

  /** The values of a message in short. */
  function summary(interpretation) {
    const value = (result) => {
      const { title, texts } = described(interpretation, result.name);
      return `${called(title, result.name)} ${shown(result, texts)}`;
    };
    return interpretation.decoded.fields.map(value).join(say("listed"));
  }

  /** A name of the spec, which is English, or its title in another language. */
  function called(title, name) {
    return state.lang === "en" ? name : text(title, name);
  }

  /** A field in the tables of an edition: its description, its title, and the texts of its type. */
  function described({ edition, message }, name) {
    const position = message.fields.findIndex((each) => each.name === name);
    const { title, type } = edition.texts.layouts[message.layout][position];
    return { description: message.fields[position], title, texts: edition.texts.types[type] };
  }

  /** A value with its unit and name; the raw integer if there is no value. */
  function shown({ raw, value, unit, reason, noValue, valueName }, { members }) {
    const member = (name) => (Array.isArray(name) ? name.map(member) : typeof name === "string" ? called(members?.[name], name) : name);
    if (typeof noValue === "string") {
      return member(noValue);
    }
    const name = typeof valueName === "string" ? ` (${member(valueName)})` : "";
    return (reason === null ? inUnit(member(value), unit) : `${say("raw")} ${listed(raw)}`) + name;
  }

  function inUnit(value, unit) {
    return `${listed(value)}${unit ? ` ${unit}` : ""}`;
  }

  function listed(value) {
    return Array.isArray(value) ? `[${value.map(listed).join(", ")}]` : String(value);
  }

  /** A link to a page of the documents, whose folder the page of a site states. */
  function linkDocuments(id, languages, path) {
    const { pages } = document.documentElement.dataset;
    at(id).hidden = !pages;
    at(id).href = pages && `${pages}${languages.includes(state.lang) ? state.lang : languages[0]}/${path}`;
  }

  function showChosen() {
    const { edition, decoded, message } = chosen;
    at("chosen-title").textContent = titleOf(chosen);
    const timing = meaning.timing(message).map((fact) => say(...fact));
    at("chosen-facts").textContent = [decoded.command, say(decoded.direction), meaning.label(edition), ...timing].join(" · ");
    linkDocuments("page", edition.texts.languages, meaning.page(chosen));
    const effects = Object.entries(edition.texts.commands[decoded.command].effects ?? {});
    const items = effects.filter(([, exemptions]) => decoded.direction === "request" && !isExempt(exemptions));
    at("effects").replaceChildren(
      ...items.map(([name]) => {
        const { level, title } = edition.texts.effects[name];
        return make("li", { className: level }, `${say(level)}: ${text(title, name)}`);
      }),
    );
  }

  /** Whether the chosen frame has a value without an effect; `exemptions` are raw integers by field. */
  function isExempt(exemptions) {
    return chosen.decoded.fields.some(({ name, raw }) =>
      [raw].flat().some((integer) => (exemptions[name] ?? []).includes(String(integer))),
    );
  }

  // Bits

  /** The field of each bit of a frame, as `byte:bit`; byte -1 is the id. */
  function owners() {
    const owners = new Map();
    const names = chosen.decoded.fields.map(({ name }) => name);
    for (const { name, elements } of chosen.message.fields) {
      for (const [byte, low, width] of elements.flat()) {
        for (let bit = low; bit < low + width && names.includes(name); bit += 1) {
          owners.set(`${byte}:${bit}`, name);
        }
      }
    }
    return owners;
  }

  function showBits() {
    const { frame, fields } = chosen.decoded;
    const ownerOf = owners();
    const numbers = new Map(fields.map(({ name }, i) => [name, i % 6]));
    const hasId = [...ownerOf.keys()].some((key) => key.startsWith("-1:"));
    const rows = hasId ? idRows(frame) : [];
    rows.push(...frame.data.map((value, byte) => ({ title: `DATA[${byte}]`, byte, first: 0, width: 8, value })));
    const body = rows.map(({ title, byte, first, width, value }) => {
      const cells = [];
      for (let column = 7; column >= 0; column -= 1) {
        const bit = first + column;
        const owner = ownerOf.get(`${byte}:${bit}`) ?? "";
        const digit = column < width ? String(Math.floor(value / 2 ** column) % 2) : "";
        const label = `${title} ${say("bit")} ${bit}: ${digit}${owner ? `, ${owner}` : ""}`;
        const button = make("button", { type: "button", tabIndex: -1, ariaLabel: label, dataset: { field: owner } }, digit);
        if (owner) {
          button.dataset.colour = numbers.get(owner);
        }
        button.addEventListener("click", () => highlight(owner));
        cells.push(digit ? make("td", {}, button) : make("td"));
      }
      const hex = make("td", { className: "hex" }, `0x${frames.hex(value, 2)}`);
      return make("tr", {}, make("th", { scope: "row" }, title), ...cells, hex);
    });
    at("bits").replaceChildren(...body);
    const first = at("bits").querySelector("button[data-field]:not([data-field=''])") ?? at("bits").querySelector("button");
    if (first) {
      first.tabIndex = 0;
    }
    highlight(field);
  }

  function idRows({ id, extended }) {
    const bits = extended ? 29 : 11;
    const rows = [];
    for (let first = 8 * Math.floor((bits - 1) / 8); first >= 0; first -= 8) {
      const width = Math.min(8, bits - first);
      rows.push({ title: `ID ${first}+`, byte: -1, first, width, value: Math.floor(id / 2 ** first) % 2 ** width });
    }
    return rows;
  }

  /** Marks the bits and the row of a field. */
  function highlight(name) {
    field = name;
    for (const element of document.querySelectorAll("[data-field]")) {
      element.classList.toggle("on", name !== "" && element.dataset.field === name);
    }
    for (const button of at("fields").querySelectorAll("button[data-field]")) {
      button.setAttribute("aria-pressed", String(button.dataset.field === name));
    }
    const description = chosen.message.fields.find((candidate) => candidate.name === name);
    at("field-says").textContent = description ? `${name}: ${place(description)}` : "";
  }

  function place({ elements }) {
    const parts = elements.map((segments) => {
      const sorted = [...segments].sort((first, second) => first[0] - second[0]);
      return sorted.map(([byte, low, width]) => {
        const where = byte < 0 ? "ID" : `DATA[${byte}]`;
        const bits = width === 1 ? `${say("bit")} ${low}` : `${say("bits")} ${low}..${low + width - 1}`;
        return width === 8 && byte >= 0 ? where : `${where} ${bits}`;
      }).join(", ");
    });
    return parts.join(" | ").replace(/^DATA\[(\d)\](?:, DATA\[\d\])*, DATA\[(\d)\]$/, "DATA[$1..$2]");
  }

  function moveInBits(event) {
    const step = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0] }[event.key];
    const cell = event.target.closest("td");
    if (!step || !cell) {
      return;
    }
    const row = cell.parentElement;
    const next = [...at("bits").rows][row.rowIndex - 1 + step[0]]?.cells[cell.cellIndex + step[1]]?.querySelector("button");
    if (next) {
      event.target.tabIndex = -1;
      next.tabIndex = 0;
      next.focus();
      highlight(next.dataset.field);
      event.preventDefault();
    }
  }

  // Fields

  function showFields() {
    const { message, decoded } = chosen;
    at("node-box").hidden = message.nodes === null; // then a field contains the node, or none does
    at("node").value = decoded.node ?? "";
    at("node").removeAttribute("aria-invalid");
    const rows = decoded.fields.map((result) => {
      const { description, title, texts } = described(chosen, result.name);
      const button = make("button", { type: "button", dataset: { field: result.name }, "aria-pressed": "false" }, result.name);
      button.addEventListener("click", () => highlight(field === result.name ? "" : result.name));
      const row = make(
        "tr",
        { dataset: { field: result.name } },
        make("th", { scope: "row" }, button, make("small", {}, text(title))),
        make("td", { dataset: { title: say("value") } }, valueInput(result, description, texts)),
        make("td", { dataset: { title: say("raw_integer") } }, rawInput(result)),
        make("td", {}, facts(description, chosen.edition, texts, result)),
      );
      row.addEventListener("focusin", () => highlight(result.name));
      return row;
    });
    at("fields").replaceChildren(...rows);
    at("field-problem").textContent = ""; // of an input that was replaced
    at("field-table").hidden = !rows.length;
    at("no-fields").hidden = rows.length > 0;
    highlight(field);
  }

  function facts(description, edition, texts, { unit, reason, missing }) {
    const by = (list) => list.map(([names, what]) => `${what ?? say("not_given")}${names ? ` (${names})` : ""}`).join(", ");
    const parts = [place(description)];
    if (reason) {
      parts.push(missing.length && reason !== "no_value" ? needed(edition, missing) : say(reason));
    }
    if (texts.resolution) {
      parts.push(`${say("resolution")} ${by(texts.resolution)}`);
    } else if (unit) {
      parts.push(unit);
    }
    if (texts.range) {
      parts.push(`${say(description.type.encoding === "float" ? "range_of" : "raw_range")} ${by(texts.range)}`);
    }
    return parts.join(" · ");
  }

  /** What to do to see a value that depends on parameters. */
  function needed(edition, missing) {
    return say("needs", missing.map((name) => parameterTitle(edition, name)).join(", "));
  }

  function valueInput(result, { isArray, type }, texts) {
    const label = say("value_of", result.name);
    if (type.enum && !isArray) {
      const select = make("select", { ariaLabel: label });
      select.append(
        ...(result.value === null ? [make("option", { value: "" }, `${say("no_name")} (${result.raw})`)] : []),
        ...type.enum.map(([, name]) => make("option", { value: name }, text(texts.members?.[name], name))),
      );
      select.value = result.value ?? "";
      select.addEventListener("change", () => enter(result.name, { value: select.value }));
      return select;
    }
    if (type.flags && !isArray) {
      return make(
        "fieldset",
        {},
        make("legend", { className: "hidden" }, label),
        ...type.flags.map(([, name]) => {
          const box = make("input", { type: "checkbox", checked: result.value.includes(name) });
          box.addEventListener("change", () => {
            const names = result.value.filter((member) => member !== name);
            enter(result.name, { value: box.checked ? [...names, name] : names });
          });
          return make("label", {}, box, text(texts.members?.[name], name));
        }),
        ...result.value.filter((bits) => typeof bits !== "string").map((bits) => `${say("no_name")}: 0x${frames.hex(bits, 2)}`),
      );
    }
    if (typeof result.noValue === "string" && !result.cases.length) {
      return make("span", {}, text(texts.members?.[result.noValue], result.noValue));
    }
    if (result.reason !== null) {
      return make("span", {}, ...(result.cases.length ? result.cases.map((each) => caseLine(each, result)) : ["–"]));
    }
    const isList = isArray && Array.isArray(result.value);
    const input = make("input", { ariaLabel: label, value: [result.value].flat().join(" "), size: 12 });
    const entered = () => (typeof result.value === "string" ? input.value : numbers(input.value, isList, Number));
    input.addEventListener("change", () => enter(result.name, { value: entered() }, input));
    const { valueName } = result;
    const name = typeof valueName === "string" ? ` (${text(texts.members?.[valueName], valueName)})` : "";
    return make("span", {}, input, (result.unit ? ` ${result.unit}` : "") + name);
  }

  /** `B: 2.5 A`: the result under some values of a parameter that is not given; without these if all have one result. */
  function caseLine({ values, value, reason, isOutside }, { unit, cases }) {
    const known = reason === null ? inUnit(value, unit) : say(reason);
    const result = isOutside ? `${known} (${say("out_of_range")})` : known;
    return make("span", { className: "case" }, cases.length > 1 ? say("case", values.join(", "), result) : result);
  }

  function rawInput(result) {
    const input = make("input", { ariaLabel: say("raw_of", result.name), value: [result.raw].flat().join(" "), size: 12 });
    input.addEventListener("change", () => enter(result.name, { raw: numbers(input.value, Array.isArray(result.raw), BigInt) }, input));
    return input;
  }

  /** The number or numbers of a text; NaN, which the codec refuses, for anything else. Whole numbers are exact. */
  function numbers(given, isArray, convert) {
    const parsed = (part) => {
      try {
        return part === "" ? NaN : /^[+-]?\d{16,}$/.test(part) ? BigInt(part) : convert(part);
      } catch {
        return NaN;
      }
    };
    return isArray ? given.trim().split(/[\s,]+/).map(parsed) : parsed(given.trim());
  }

  /** Encodes the message with another value of one field, or for another node, and shows the frame; without one, there is nothing to copy. */
  function enter(name, { value, raw, node }, input) {
    if (!chosen) {
      return; // the address lost its frame, which hides an input that has changed
    }
    const { edition, decoded } = chosen;
    try {
      const changed = value === undefined ? raw : meaning.rawOf(chosen, name, value);
      const frame = meaning.encode(chosen, { node, raw: name === "" ? decoded.raw : { ...decoded.raw, [name]: changed } });
      Object.assign(state, { edition: meaning.label(edition), direction: decoded.direction, command: decoded.command });
      const focused = document.activeElement?.ariaLabel;
      use(frame);
      [...at("fields").querySelectorAll("input, select")].find((input) => input.ariaLabel === focused)?.focus();
    } catch (error) {
      const [limits, raws] = error.values ?? [];
      const accepted = [limits, raws && `${say("raw")} ${raws}`].filter(Boolean).join(" · ");
      const reason = canwright.labels[state.lang][error.refusal] ?? say("not_finite");
      at("field-problem").textContent = say("refused", error.field || name || say("node_number"), reason, accepted && ` (${accepted})`);
      input?.setAttribute("aria-invalid", "true");
      at("code").hidden = true;
      at("frame").value = "";
    }
  }

  // Comparison

  /** The same frame in another edition, field by field. */
  function showComparison() {
    const others = meaning.editions.filter((edition) => edition !== chosen.edition);
    const second = others.find((edition) => meaning.label(edition) === state.compare);
    const options = others.map((edition) => make("option", { value: meaning.label(edition) }, meaning.label(edition)));
    at("compare-box").hidden = !others.length;
    at("compare").replaceChildren(make("option", { value: "" }, say("no_edition")), ...options);
    at("compare").value = second ? state.compare : "";
    at("compared").hidden = !second;
    if (second) {
      const likeness = ({ decoded }) => (decoded.direction === chosen.decoded.direction ? 2 : 0) + (decoded.command === chosen.decoded.command ? 1 : 0);
      const fitting = interpretations.filter(({ edition }) => edition === second);
      const [same = null] = [...fitting].sort((left, right) => likeness(right) - likeness(left));
      compare([chosen, same], [chosen.edition, second]);
    }
  }

  function compare(pair, editions) {
    const names = new Set(pair.flatMap((each) => each?.decoded.fields.map(({ name }) => name) ?? []));
    const messages = pair.map((each) => (each ? `${titleOf(each)} · ${say(each.decoded.direction)}` : say("no_message")));
    const rows = [...names].map((name) => [name, ...pair.map((each) => contentOf(each, name))]);
    at("compare-head").replaceChildren(...[say("field"), ...editions.map(meaning.label)].map((title) => make("th", { scope: "col" }, title)));
    at("compare-rows").replaceChildren(
      ...[[say("message"), ...messages], ...rows].map(([name, left, right]) => {
        const header = make("th", { scope: "row" }, left === right ? name : `${name} ≠`);
        return make("tr", { className: left === right ? "" : "differs" }, header, make("td", {}, left), make("td", {}, right));
      }),
    );
  }

  /** The value of a field with its position, resolution and range; a dash without it. */
  function contentOf(interpretation, name) {
    const result = interpretation?.decoded.fields.find((field) => field.name === name);
    if (!result) {
      return "–";
    }
    const { description, texts } = described(interpretation, name);
    return `${shown(result, texts)} · ${facts(description, interpretation.edition, texts, result)}`;
  }

  // Code

  function showCode() {
    at("code").hidden = false;
    at("link").textContent = location.href;
    at("bytes").textContent = chosen.decoded.frame.data.map((byte) => frames.hex(byte, 2)).join(" ");
    at("cansend").textContent = code.cansend(chosen);
    const obstacle = code.obstacle(chosen);
    const instead = obstacle === "needs" ? needed(chosen.edition, [chosen.variant.parameter]) : obstacle && say(obstacle);
    for (const language of ["c", "python"]) {
      at(language).textContent = instead || code[language](chosen);
      document.querySelector(`[data-copy="${language}"]`).disabled = instead !== "";
    }
  }

  function copy(button) {
    const source = at(button.dataset.copy);
    const range = document.createRange();
    range.selectNodeContents(source);
    getSelection().removeAllRanges();
    getSelection().addRange(range);
    document.execCommand("copy"); // the only way that works from a file
    at("copied").textContent = say("copied");
  }

  // The page

  function showLanguage() {
    document.documentElement.lang = state.lang === "zh" ? "zh-Hans" : "en";
    document.title = say("title");
    for (const element of document.querySelectorAll("[data-label]")) {
      element.textContent = say(element.dataset.label);
    }
    linkDocuments("documents", meaning.editions.flatMap(({ texts }) => texts.languages), "index.html");
    for (const button of document.querySelectorAll("[data-lang]")) {
      button.setAttribute("aria-pressed", String(button.dataset.lang === state.lang));
    }
  }

  function start() {
    readAddress();
    showLanguage();
    showParameters();
    showLog();
    update();
  }

  at("frame").addEventListener("input", () => {
    take(at("frame").value);
  });
  at("frame").addEventListener("paste", (event) => {
    const content = event.clipboardData.getData("text");
    if (content.trim().includes("\n")) {
      event.preventDefault();
      openText(content);
    }
  });
  at("compare").addEventListener("change", () => {
    state.compare = at("compare").value;
    show();
  });
  at("edition").addEventListener("change", () => {
    state.edition = at("edition").value;
    at("message").value = "";
    compose();
  });
  at("message").addEventListener("change", compose);
  at("open").addEventListener("click", () => at("file").click());
  at("file").addEventListener("change", () => {
    [...at("file").files].forEach((file) => openLog(file));
    at("file").value = ""; // so that the same file can be opened again
  });
  at("node").addEventListener("change", () => enter("", { node: Number(at("node").value || NaN) }, at("node")));
  at("log-previous").addEventListener("click", () => turn(-1));
  at("log-next").addEventListener("click", () => turn(1));
  at("bits").addEventListener("keydown", moveInBits);
  at("bits").addEventListener("focusin", (event) => highlight(event.target.dataset.field ?? ""));
  for (const button of document.querySelectorAll("[data-copy]")) {
    button.addEventListener("click", () => copy(button));
  }
  for (const button of document.querySelectorAll("[data-lang]")) {
    button.addEventListener("click", () => {
      state.lang = button.dataset.lang;
      writeAddress();
      start();
    });
  }
  document.addEventListener("dragover", (event) => event.preventDefault());
  document.addEventListener("drop", (event) => {
    event.preventDefault();
    const file = event.dataTransfer.files[0];
    const content = event.dataTransfer.getData("text");
    if (file) {
      openLog(file);
    } else if (content) {
      openText(content);
    }
  });
  window.addEventListener("hashchange", start);
  start();
  document.body.classList.add("ready"); // shown as a whole, so nothing moves
})();
