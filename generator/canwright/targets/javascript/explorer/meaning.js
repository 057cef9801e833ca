"use strict";

/** What frames can mean, without a page: all messages that fit, in the order of their probability. */
canwright.meaning = (() => {
  const editions = canwright.editions.map(({ tables, texts, bindings }) => {
    const codec = canwright.createEdition(tables);
    const messages = new Map(codec.MESSAGES.map((message) => [`${message.direction} ${message.command}`, message]));
    for (const { request, reply } of tables.answers) {
      const key = `reply ${codec.MESSAGES[request].command}`;
      if (!messages.has(key)) {
        messages.set(key, codec.MESSAGES[reply]);
      }
    }
    return { name: texts.edition, family: texts.family, codec, texts, bindings, messages };
  });
  editions.sort((one, other) => (other.texts.date ?? "").localeCompare(one.texts.date ?? ""));
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
    const found = new Map();
    for (const { codec, texts } of editions) {
      for (const [name, { values }] of Object.entries(codec.PARAMETERS)) {
        const known = found.get(name) ?? { name, values: values ? [] : null, texts: texts.parameters[name] };
        known.values?.push(...values.filter((value) => !known.values.includes(value)));
        found.set(name, known);
      }
    }
    return [...found.values()];
  }

  /** The given parameters that an edition has, without those that are invalid in it. */
  function known(edition, given) {
    const own = ([name, value]) => Object.hasOwn(edition.codec.PARAMETERS, name) && isValid(edition, name, String(value));
    return Object.fromEntries(Object.entries(given).filter(own));
  }

  function isValid(edition, name, value) {
    const { values, minimum, maximum } = edition.codec.PARAMETERS[name];
    if (values) {
      return values.includes(value);
    }
    const number = canwright.rational(value);
    const isBelow = (one, other) => one[0] * other[1] < other[0] * one[1];
    const low = minimum === undefined ? null : canwright.rational(minimum);
    const high = maximum === undefined ? null : canwright.rational(maximum);
    return number !== null && number[0] > 0n && !(low && isBelow(number, low)) && !(high && isBelow(high, number));
  }

  /**
   * The values of a parameter under which a message exists, apart for each set of fields that it `decides`.
   * One item, which can be null, if no parameter decides on the fields.
   */
  function variants(edition, message, given) {
    const { parameter, fields } = message;
    const only = edition.texts.commands[message.command].only ?? {};
    if (parameter === null) {
      const [condition] = Object.entries(only);
      return [condition ? { parameter: condition[0], values: condition[1], decides: false } : null];
    }
    const groups = new Map();
    for (const value of given[parameter] ? [given[parameter]] : edition.codec.PARAMETERS[parameter].values) {
      if (!only[parameter] || only[parameter].includes(value)) {
        const key = fields.map((field) => (field.only === null || field.only.includes(value) ? 1 : 0)).join("");
        groups.set(key, [...(groups.get(key) ?? []), value]);
      }
    }
    return [...groups.values()].map((values) => ({ parameter, values, decides: true }));
  }

  /** The number of bits of a frame that a message determines. */
  function determined(message, decoded) {
    const widths = new Map(message.fields.map((field) => [field.name, field.elements.length * field.type.width]));
    return 8 * message.length - decoded.fields.reduce((sum, { name }) => sum + widths.get(name), 0);
  }

  /** Why a sender that obeys the spec cannot send a frame: "range", "reserved", or empty. */
  function deviation(edition, decoded, parameters) {
    const { direction, command, node, raw, frame } = decoded;
    const encode = direction === "request" ? edition.codec.encodeRequest : edition.codec.encodeReply;
    try {
      const again = encode(command, { node, raw, parameters });
      return canwright.frames.format(again.frame) === canwright.frames.format(frame) ? "" : "reserved";
    } catch (error) {
      if (error instanceof canwright.CodecError) {
        return "range";
      }
      throw error;
    }
  }

  function interpretation(edition, candidate, variant, frame, given) {
    const message = edition.messages.get(`${candidate.direction} ${candidate.command}`);
    const chosen = variant?.decides ? { ...given, [variant.parameter]: variant.values[0] } : given;
    let decoded;
    try {
      decoded = edition.codec.decodeAs(candidate.direction, candidate.command, frame, chosen);
    } catch (error) {
      if (error instanceof canwright.CodecError) {
        return null;
      }
      throw error;
    }
    const differs = deviation(edition, decoded, chosen);
    const isAbsent = variant && !variant.decides && given[variant.parameter] && !variant.values.includes(given[variant.parameter]);
    const isAnnounced = edition.texts.commands[candidate.command]?.implemented === false;
    const isOpposite = frame.sent !== undefined && frame.sent !== null && frame.sent !== (candidate.direction === "request");
    const penalty = ({ reserved: 3, range: 2 }[differs] ?? 0) + (isOpposite ? 0.5 : 0);
    return {
      edition,
      message,
      decoded,
      variant,
      parameters: chosen,
      deviation: differs,
      rank: [penalty + (isAnnounced ? 4 : 0) + (isAbsent ? 5 : 0), -determined(message, decoded)],
    };
  }

  /** All messages that a frame can be, the most probable first. */
  function interpret(frame, parameters = {}) {
    const found = [];
    for (const edition of editions) {
      const given = known(edition, parameters);
      for (const candidate of edition.codec.candidates(frame)) {
        const message = edition.messages.get(`${candidate.direction} ${candidate.command}`);
        for (const variant of variants(edition, message, given)) {
          const one = interpretation(edition, candidate, variant, frame, given);
          if (one) {
            found.push(one);
          }
        }
      }
    }
    return found.sort((one, other) => one.rank[0] - other.rank[0] || one.rank[1] - other.rank[1]);
  }

  /** The message of an edition with the smallest raw integers that are allowed, as a start for entering values. */
  function blank(edition, direction, command, parameters) {
    const given = known(edition, parameters);
    const message = edition.messages.get(`${direction} ${command}`);
    const [variant] = variants(edition, message, given);
    const chosen = variant?.decides ? { ...given, [variant.parameter]: variant.values[0] } : given;
    const present = message.fields.filter(({ fixed, only }) => fixed === null && (only === null || only.includes(chosen[message.parameter])));
    const encode = direction === "request" ? edition.codec.encodeRequest : edition.codec.encodeReply;
    const raw = Object.fromEntries(present.map((field) => [field.name, start(field)]));
    const node = message.nodes ? message.nodes[0] : undefined;
    const decoded = encode(command, { node, raw, parameters: chosen });
    return { edition, message, decoded, variant, parameters: chosen, deviation: "", rank: [0, 0] };
  }

  function start({ isArray, elements, type }) {
    const bound = Array.isArray(type.range) && !Array.isArray(type.range[0]) ? canwright.rational(type.range[0]) : null;
    const low = bound && bound[0] > 0n && type.encoding !== "float" ? -(-bound[0] / bound[1]) : 0;
    const raw = type.enum ? type.enum[0][0] : low;
    return isArray ? elements.map(() => raw) : raw;
  }

  return { editions, label, find, parameters, known, interpret, blank };
})();
