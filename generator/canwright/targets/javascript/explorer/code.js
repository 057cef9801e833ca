"use strict";

/** The program text of a message: cansend, C and Python. */
canwright.code = (() => {
  const { own } = canwright;

  function cansend({ decoded }) {
    return `cansend can0 ${canwright.frames.format(decoded.frame)}`;
  }

  /** Why no program of C or Python can send a message: `needs` a parameter, "range", "absent", or empty. */
  function obstacle({ deviation, assumed }) {
    return assumed.length > 1 ? "needs" : deviation === "reserved" ? "" : deviation;
  }

  /** The code of a message as a number in C and Python; null if it need not be given. */
  function givenCode({ keys: [key] }, { code }) {
    return code === undefined || code === key.values[0] ? null : `0x${code.toString(16).toUpperCase()}`;
  }

  function cInteger(raw, { width, encoding }) {
    if (width <= 32 && encoding === "signed") {
      return BigInt(raw) === -(2n ** 31n) ? "(-2147483647 - 1)" : String(raw);
    }
    if (encoding === "signed") {
      return BigInt(raw) === -(2n ** 63n) ? "(-INT64_C(9223372036854775807) - 1)" : `INT64_C(${raw})`;
    }
    const unsigned = width <= 32 ? `${raw}u` : `UINT64_C(${raw})`;
    return encoding === "float" ? `{${unsigned}}` : unsigned; // the bits of a float are in a struct
  }

  /** The parameters that a program can name, each with its value. */
  function named(parameters, names) {
    return Object.entries(parameters).map(([name, value]) => ({ ...names.parameters[name], value: String(value) }));
  }

  function c({ edition: { bindings: { c: names } }, message, decoded, parameters }) {
    const { name, needsParameters } = names.messages[`${message.direction} ${message.command}`];
    const lines = [`#include <${names.source}>`, ""];
    if (needsParameters) {
      const items = named(parameters, names).map((parameter) => `.${parameter.name} = ${parameter.members?.[parameter.value] ?? cRatio(parameter.value)}`);
      lines.push(`const ${names.parametersType} parameters = {${items.join(", ") || "0"}};`);
    }
    const types = new Map(message.fields.map((field) => [field.name, field.type]));
    const fields = decoded.fields.map((field) => {
      const raws = Array.isArray(field.raw) ? `{${field.raw.map((raw) => cInteger(raw, types.get(field.name))).join(", ")}}` : null;
      return `.${own(names.fields, field.name) ?? field.name} = ${raws ?? cInteger(field.raw, types.get(field.name))}`;
    });
    const code = givenCode(message, decoded);
    if (code !== null) {
      fields.push(`.frame_code = ${code}u`);
    }
    if (fields.length) {
      lines.push(`const ${name}_t message = {${fields.join(", ")}};`);
    }
    const rest = [message.nodes ? `${decoded.node}u` : [], fields.length ? "&message" : [], needsParameters ? "&parameters" : []];
    lines.push(`${names.frame} frame;`, `const canwright_status_t status = ${name}_encode(${["&frame", ...rest.flat()].join(", ")});`);
    return lines.join("\n");
  }

  function cRatio(value) {
    const [numerator, denominator] = canwright.rational(value);
    return `{${numerator}, ${denominator}u}`;
  }

  function python({ edition: { texts, bindings: { python: names } }, message, decoded, parameters }) {
    const { name, needsParameters } = names.messages[`${message.direction} ${message.command}`];
    const imports = new Set([name]);
    const hasValues = decoded.fields.every((field) => field.reason === null);
    const enums = new Map(message.fields.map((field, i) => [field.name, names.types?.[texts.layouts[message.layout][i].type]]));
    const items = message.nodes ? [`node=${decoded.node}`] : []; // otherwise a field contains it
    for (const { name: field, raw, value } of decoded.fields) {
      const argument = hasValues ? pythonValue(value, enums.get(field), Array.isArray(raw) && Array.isArray(value), imports) : pythonNumber(raw);
      items.push(`${own(names.fields, field) ?? field}=${argument}`);
    }
    const code = givenCode(message, decoded);
    if (code !== null) {
      items.push(`frame_code=${code}`);
    }
    const given = named(parameters, names);
    if (given.length && (needsParameters || !hasValues)) {
      imports.add(names.parametersType);
      const known = given.map((parameter) => {
        if (parameter.type) {
          imports.add(parameter.type);
        }
        return `${parameter.name}=${parameter.members?.[parameter.value] ?? pythonRatio(parameter.value)}`;
      });
      items.push(`parameters=${names.parametersType}(${known.join(", ")})`);
    }
    const call = hasValues ? name : `${name}.from_raw`;
    const fraction = items.some((item) => item.includes("Fraction(")) ? "from fractions import Fraction\n" : "";
    return [
      `${fraction}from ${names.source} import ${[...imports].sort().join(", ")}`,
      "",
      `message = ${called(call, items)}`,
      'print(f"{message.can_id:X}", message.encode().hex(" "))',
    ].join("\n");
  }

  /** A call on one line, or with one argument per line if it is long. */
  function called(name, items) {
    const line = `${name}(${items.join(", ")})`;
    return line.length < 80 ? line : `${name}(\n${items.map((item) => `    ${item},\n`).join("")})`;
  }

  function pythonValue(value, enumeration, isArray, imports) {
    if (isArray && Array.isArray(value)) {
      return `[${value.map((element) => pythonValue(element, enumeration, false, imports)).join(", ")}]`;
    }
    if (!enumeration) {
      return typeof value === "string" ? JSON.stringify(value) : pythonNumber(value);
    }
    imports.add(enumeration.type);
    const members = [value].flat().map((name) => enumeration.members[name]);
    return members.join(" | ") || `${enumeration.type}(0)`;
  }

  function pythonNumber(value) {
    return Array.isArray(value) ? `[${value.map(pythonNumber).join(", ")}]` : String(value);
  }

  function pythonRatio(value) {
    const [numerator, denominator] = canwright.rational(value);
    return denominator === 1n ? String(numerator) : /^[\d.]+$/.test(value) ? value : `Fraction(${numerator}, ${denominator})`;
  }

  return { cansend, c, python, obstacle };
})();
