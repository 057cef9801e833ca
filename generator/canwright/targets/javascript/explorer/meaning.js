"use strict";

/** What frames can mean, without a page: all messages that fit, in the order of their probability. */
canwright.meaning = (() => {
  const { own } = canwright;
  const editions = canwright.editions.map(({ tables, texts, bindings, pages = {}, neighbours = [] }) => {
    const codec = canwright.createEdition(tables);
    const messages = new Map(codec.MESSAGES.map((message) => [`${message.direction} ${message.command}`, message]));
    const isFirst = ({ request }, i) => tables.answers.findIndex((plan) => plan.request === request) === i;
    for (const { request, reply } of tables.answers.filter(isFirst)) {
      messages.set(`reply ${codec.MESSAGES[request].command}`, codec.MESSAGES[reply]);
    }
    return { name: texts.edition, family: texts.family, codec, texts, bindings, pages, neighbours, messages };
  });
  editions.sort((first, second) => (second.texts.date ?? "").localeCompare(first.texts.date ?? ""));
  const families = new Set(editions.map(({ family }) => family));

  /** What people call an edition: its family too if there are several. */
  function label(edition) {
    return families.size > 1 ? `${edition.family} ${edition.name}` : edition.name;
  }

  function find(name) {
    return editions.find((edition) => label(edition) === name || edition.name === name);
  }

  /** The parameters of all editions: name, the values of a choice, texts. */
  function parameters() {
    const byName = new Map();
    for (const { codec, texts } of editions) {
      for (const [name, { values }] of Object.entries(codec.PARAMETERS)) {
        const known = byName.get(name) ?? { name, values: values ? [] : null, texts: texts.parameters[name] };
        known.values?.push(...values.filter((value) => !known.values.includes(value)));
        byName.set(name, known);
      }
    }
    return [...byName.values()];
  }

  /** The given parameters that an edition has, without those that are invalid in it. */
  function known(edition, given) {
    const own = ([name, value]) => Object.hasOwn(edition.codec.PARAMETERS, name) && isValid(edition, name, String(value));
    return Object.fromEntries(Object.entries(given).filter(own).map(([name, value]) => [name, String(value)]));
  }

  function isValid({ codec }, name, value) {
    try {
      codec.checkParameters({ [name]: value });
    } catch (error) {
      if (error instanceof RangeError) {
        return false;
      }
      throw error;
    }
    const { values, whole } = codec.PARAMETERS[name];
    return values !== undefined || whole === true || canwright.rational(value)[0] > 0n;
  }

  /** The names of given parameters that are valid in no edition. */
  function invalid(given) {
    return Object.keys(given).filter((name) => !editions.some((edition) => Object.hasOwn(known(edition, given), name)));
  }

  /** The parameter values that a command is limited to, by parameter. */
  function limits(edition, { command }) {
    return edition.texts.commands[command].only ?? {};
  }

  /** Parameters under which a message exists: given ones that permit it, and those of which it leaves one value. */
  function settled(edition, message, given) {
    const only = limits(edition, message);
    const permitted = Object.entries(given).filter(([name, value]) => own(only, name)?.includes(value) ?? true);
    const single = Object.entries(only).filter(([, values]) => values.length === 1).map(([name, [value]]) => [name, value]);
    return Object.fromEntries([...permitted, ...single]);
  }

  /**
   * The values of a parameter under which a message exists, apart for each set of fields that it `decides`.
   * One item, which can be null, if no parameter decides on the fields.
   */
  function variants(edition, message, parameters) {
    const { parameter, fields } = message;
    const only = limits(edition, message);
    if (parameter === null) {
      const [name] = Object.keys(only);
      return [name === undefined ? null : { parameter: name, values: possible(edition, message, parameters, name), decides: false }];
    }
    const groups = new Map();
    for (const value of possible(edition, message, parameters, parameter)) {
      const key = fields.map((field) => (field.only === null || field.only.includes(value) ? 1 : 0)).join("");
      groups.set(key, [...(groups.get(key) ?? []), value]);
    }
    return [...groups.values()].map((values) => ({ parameter, values, decides: true }));
  }

  /** The values that a choice can have where a message exists. */
  function possible(edition, message, parameters, name) {
    const given = own(parameters, name);
    return given === undefined ? (own(limits(edition, message), name) ?? edition.codec.PARAMETERS[name].values) : [given];
  }

  /** The parameters of a variant: one set, or several that have the same fields. */
  function assumptions(parameters, variant) {
    return variant?.decides ? variant.values.map((value) => ({ ...parameters, [variant.parameter]: value })) : [parameters];
  }

  /** The number of bits of a frame that a message determines. */
  function determined(message, decoded) {
    const widths = new Map(message.fields.map((field) => [field.name, field.elements.length * field.type.width]));
    return 8 * message.length - decoded.fields.reduce((sum, { name }) => sum + widths.get(name), 0);
  }

  /** The message of raw integers and a code under the first of some assumptions that allows them. Throws CodecError if none does. */
  function encodedUnder(edition, { direction, command }, { node, raw, code }, assumed) {
    const encode = direction === "request" ? edition.codec.encodeRequest : edition.codec.encodeReply;
    let refused;
    for (const parameters of assumed) {
      try {
        return encode(command, { node, raw, code, parameters });
      } catch (error) {
        if (!(error instanceof canwright.CodecError)) {
          throw error;
        }
        refused ??= error;
      }
    }
    throw refused;
  }

  /** The frame of a message with other raw integers or another node. Throws CodecError. */
  function encode({ edition, message, decoded, assumed }, { node = decoded.node ?? undefined, raw = decoded.raw }) {
    return encodedUnder(edition, message, { node, raw, code: decoded.code }, assumed).frame;
  }

  /** The raw integer of a value of a field. Throws CodecError, also if its scale depends on a parameter that is not given. */
  function rawOf({ edition, message, decoded, assumed }, name, value) {
    const { missing } = decoded.fields.find((field) => field.name === name);
    if (missing.length) {
      throw new canwright.CodecError("missing_parameter", `${name} depends on ${missing.join(", ")}`, name);
    }
    return edition.codec.rawOf(message.direction, message.command, name, value, assumed[0]);
  }

  /** Why a sender that obeys the spec cannot send a frame: "range", "reserved", or empty. */
  function deviation(edition, message, decoded, assumed) {
    const { node, raw, code, frame } = decoded;
    try {
      const again = encodedUnder(edition, message, { node: node ?? undefined, raw, code }, assumed);
      return canwright.frames.format(again.frame) === canwright.frames.format(frame) ? "" : "reserved";
    } catch (error) {
      if (error instanceof canwright.CodecError) {
        return "range";
      }
      throw error;
    }
  }

  /**
   * The fields of a frame. `missing` are the parameters that a value depends on and that are not given. If one is a choice,
   * the field has no value but `cases`: the results `{ values, value, reason }` by its values.
   */
  function fieldsOf(edition, message, decoded, { parameters, variant, assumed }) {
    const types = new Map(message.fields.map(({ name, type }) => [name, type]));
    return decoded.fields.map((field, position) => {
      if (typeof field.noValue === "string") {
        return { ...field, missing: [], cases: [] }; // the name depends on no parameter
      }
      const { linear } = types.get(field.name);
      const by = linear?.by;
      const isOpen = by !== undefined && own(parameters, by) === undefined;
      const choices = isOpen && variant?.parameter === by ? variant.values : by && possible(edition, message, parameters, by);
      const lines = by ? choices.map((value) => own(linear.cases, value)) : [linear];
      const needed = [...(isOpen ? [by] : []), ...lines.flatMap((line) => line?.times?.split(/[*/]/).filter(Boolean))];
      const missing = [...new Set(needed)].filter((name) => name !== undefined && own(parameters, name) === undefined);
      if (!isOpen) {
        return { ...field, missing, cases: [] };
      }
      const under = (value) => {
        const given = { ...assumed[0], [by]: value };
        const { value: converted, reason } = decodedAs(edition, message, decoded.frame, given).fields[position];
        const isOutside = reason === null && !edition.codec.allows(message.direction, message.command, field.name, field.raw, given);
        return { value: converted, reason, isOutside };
      };
      return { ...field, value: null, reason: "missing_parameter", missing, cases: grouped(choices, under) };
    });
  }

  function decodedAs(edition, { direction, command }, frame, parameters) {
    return edition.codec.decodeAs(direction, command, frame, parameters);
  }

  /** The different results, each with the parameter values under which it applies. */
  function grouped(values, result) {
    const groups = new Map();
    for (const name of values) {
      const { value, reason, isOutside } = result(name);
      const key = `${reason} ${value} ${isOutside}`;
      groups.set(key, { values: [...(groups.get(key)?.values ?? []), name], value, reason, isOutside });
    }
    return [...groups.values()];
  }

  /** A frame as a message, with the fields that the message has under a variant; null if it is another message. */
  function interpretation(edition, candidate, variant, frame, given) {
    const message = messageOf(edition, candidate);
    const isOne = variant?.decides && variant.values.length === 1;
    const parameters = { ...settled(edition, message, given), ...(isOne ? { [variant.parameter]: variant.values[0] } : {}) };
    const assumed = assumptions(parameters, variant);
    let decoded;
    try {
      decoded = decodedAs(edition, message, frame, assumed[0]);
    } catch (error) {
      if (error instanceof canwright.CodecError) {
        return null;
      }
      throw error;
    }
    const { direction, command, node, code, raw } = decoded;
    const fields = fieldsOf(edition, message, decoded, { parameters, variant, assumed });
    const isAbsent = Object.entries(limits(edition, message)).some(([name, values]) => !values.includes(own(given, name) ?? values[0]));
    const differs = deviation(edition, message, decoded, assumed);
    const isAnnounced = edition.texts.commands[command].implemented === false;
    const isOpposite = frame.sent !== undefined && frame.sent !== null && frame.sent !== (direction === "request");
    const isZero = Object.values(raw).flat().every((integer) => Number(integer) === 0);
    const penalty = { reserved: 3, range: 2 }[differs] ?? 0;
    return {
      edition,
      message,
      decoded: { direction, command, node, code, frame: decoded.frame, raw, fields },
      variant,
      parameters,
      assumed,
      deviation: isAbsent ? "absent" : differs,
      // many recorders mark every frame as received, so the mark decides among equals, or where all values are 0
      rank: [penalty + (isAnnounced ? 4 : 0) + (isAbsent ? 5 : 0), isOpposite && isZero ? 1 : 0, -determined(message, decoded), isOpposite ? 1 : 0],
    };
  }

  function messageOf(edition, { direction, command }) {
    return edition.messages.get(`${direction} ${command}`);
  }

  /** The ids of messages to or from the first node, for bytes without an id. */
  function ids(parameters) {
    const frames = new Map();
    for (const edition of editions) {
      const given = known(edition, parameters);
      for (const { base, step, nodes, keys, extended, idParameter, idParameterStep = 0 } of edition.messages.values()) {
        const value = Number(own(given, idParameter) ?? edition.codec.PARAMETERS[idParameter]?.minimum ?? 0);
        const bits = keys.flatMap(({ segments, values }) => segments.filter(([byte]) => byte < 0).map(([, low, , rawLow]) => (Number(values[0]) >> rawLow) << low));
        const id = bits.reduce((sum, part) => sum | part, base + (nodes ? nodes[0] * step : 0) + value * idParameterStep);
        frames.set(`${id} ${extended}`, { id, extended });
      }
    }
    return [...frames.values()];
  }

  /** All messages that a frame can be, the most probable first, and those of the edition with a label before all. */
  function interpret(frame, parameters = {}, leading = "") {
    const every = frame.id === null ? ids(parameters).map((id) => ({ ...frame, ...id })) : [frame];
    const interpretations = every.flatMap((each) => interpretationsOf(each, parameters));
    const order = ({ edition }) => (leading === "" || edition === find(leading) ? 0 : 1);
    const difference = (first, second) => first.rank.map((part, i) => part - second.rank[i]).find((part) => part !== 0) ?? 0;
    return interpretations.sort((first, second) => order(first) - order(second) || difference(first, second));
  }

  function interpretationsOf(frame, parameters) {
    const interpretations = [];
    for (const edition of editions) {
      const given = known(edition, parameters);
      for (const candidate of edition.codec.candidates(frame, given)) {
        const message = messageOf(edition, candidate);
        for (const variant of variants(edition, message, settled(edition, message, given))) {
          const interpreted = interpretation(edition, candidate, variant, frame, given);
          if (interpreted) {
            interpretations.push(interpreted);
          }
        }
      }
    }
    return interpretations;
  }

  /** The parameters in the id and the constants of a message that are not given, with their lowest values. */
  function needed(edition, direction, command, given) {
    const message = messageOf(edition, { direction, command });
    const names = [message.idParameter, ...message.fields.map(({ parameter }) => parameter)];
    const missing = names.filter((name) => name && known(edition, given)[name] === undefined);
    return Object.fromEntries(missing.map((name) => [name, String(edition.codec.PARAMETERS[name].minimum ?? 0)]));
  }

  /** The frame of a message with the smallest raw integers that are allowed, as a start for entering values. */
  function blank(edition, direction, command, given) {
    const message = messageOf(edition, { direction, command });
    const parameters = settled(edition, message, known(edition, given));
    const [variant] = variants(edition, message, parameters);
    const assumed = assumptions(parameters, variant);
    const present = message.fields.filter(({ isValue, only }) => isValue && (only === null || only.includes(assumed[0][message.parameter])));
    const raw = Object.fromEntries(present.map((field) => [field.name, start(field)]));
    return encodedUnder(edition, message, { node: message.nodes ? message.nodes[0] : undefined, raw }, assumed).frame;
  }

  function start({ isArray, elements, type }) {
    const bound = Array.isArray(type.range) && !Array.isArray(type.range[0]) ? canwright.rational(type.range[0]) : null;
    const low = bound && bound[0] > 0n && type.encoding !== "float" ? -(-bound[0] / bound[1]) : 0;
    const raw = type.enum ? type.enum[0][0] : low;
    return isArray ? elements.map(() => raw) : raw;
  }

  /** When a message is sent: labels, each with its value. */
  function timing({ sent = [], everyMs, timeoutMs }) {
    const occasions = sent.map((occasion) => (occasion === "cyclic" && everyMs ? ["every", everyMs] : [occasion]));
    return timeoutMs ? [...occasions, ["timeout", timeoutMs]] : occasions;
  }

  /** The page of the command of a message in the documents, below the folder of a language. */
  function page({ edition, decoded: { command } }) {
    const folder = families.size > 1 ? `${edition.family}-${edition.name}` : edition.name;
    return `${folder}/commands/${own(edition.pages, command) ?? `${command}.html`}`;
  }

  /** Items of editions, those of one key once, each with the `labels` of its editions. */
  function labelled(edition, itemsOf) {
    const groups = new Map();
    for (const each of edition ? [edition] : editions) {
      for (const [key, item] of itemsOf(each)) {
        groups.set(key, { ...item, labels: [...(groups.get(key)?.labels ?? []), label(each)] });
      }
    }
    return [...groups.values()];
  }

  /** Why a frame is no message, each reason once with its direction and the labels of the editions that give it. */
  function reasons(frame, edition) {
    const reason = (direction, decode) => {
      try {
        decode(frame);
        return [];
      } catch ({ message, refusal, values = [] }) {
        return [[`${direction} ${message}`, { direction, message, refusal, values }]];
      }
    };
    return labelled(edition, ({ codec }) => [...reason("request", codec.decodeRequest), ...reason("reply", codec.decodeReply)]);
  }

  /** Whose a frame is, as editions state of ids that are not theirs: titles, each with the labels of the editions that have it. */
  function neighbours({ id, extended }, edition) {
    const isOf = ({ first, last, step }) => id >= first && id <= last && (id - first) % step === 0 && extended === id > 0x7ff;
    return labelled(edition, (each) => each.neighbours.filter(isOf).map(({ title }) => [JSON.stringify(title), { title }]));
  }

  return { editions, label, find, parameters, invalid, interpret, reasons, neighbours, needed, blank, encode, rawOf, timing, page };
})();
