"use strict";

/** The program text of a message: cansend, C and Python. */
canwright.code = (() => {
  function cansend({ decoded }) {
    return `cansend can0 ${canwright.frames.format(decoded.frame)}`;
  }

  /** Why no program of C or Python can send a message: `needs` a parameter, "range", "absent", or empty. */
  function obstacle({ deviation, assumed }) {
    return assumed.length > 1 ? "needs" : deviation === "reserved" ? "" : deviation;
  }

  function own(object, name) {
    return object && Object.hasOwn(object, name) ? object[name] : undefined;
  }

  function cInteger(raw, { width, encoding }) {
    if (width <= 32 && encoding === "signed") {
      return BigInt(raw) === -(2n ** 31n) ? "(-2147483647 - 1)" : String(raw);
    }
    if (encoding === "signed") {
      return BigInt(raw) === -(2n ** 63n) ? "(-INT64_C(9223372036854775807) - 1)" : `INT64_C(${raw})`;
    }
    return width <= 32 ? `${raw}u` : `UINT64_C(${raw})`;
  }

  /** The parameters that a program can name, as `[name, value, names in the bindings]`. */
  function named(parameters, { parameters: names }) {
    return Object.entries(parameters).map(([name, value]) => [name, String(value), names[name]]);
  }

  function c({ edition: { bindings }, message, decoded, parameters }) {
    const { direction, command } = message;
    const name = bindings.messages[`${direction} ${command}`].c;
    const given = named(parameters, bindings);
    const takes = bindings.messages[`${direction} ${command}`].takesParameters;
    const lines = [`#include <${bindings.header}>`, ""];
    if (takes) {
      const items = given.map(([, value, one]) => `.${one.c} = ${one.values ? one.values[value].c : cRatio(value)}`);
      lines.push(`const ${bindings.prefix}_parameters_t parameters = {${items.join(", ") || "0"}};`);
    }
    const types = new Map(message.fields.map((field) => [field.name, field.type]));
    const fields = decoded.fields.map((field) => {
      const raws = Array.isArray(field.raw) ? `{${field.raw.map((raw) => cInteger(raw, types.get(field.name))).join(", ")}}` : null;
      return `.${own(bindings.members, field.name) ?? field.name} = ${raws ?? cInteger(field.raw, types.get(field.name))}`;
    });
    if (fields.length) {
      lines.push(`const ${name}_t message = {${fields.join(", ")}};`);
    }
    const rest = [message.nodes ? `${decoded.node}u` : [], fields.length ? "&message" : [], takes ? "&parameters" : []];
    lines.push("canwright_frame_t frame;", `const canwright_status_t status = ${name}_encode(${["&frame", ...rest.flat()].join(", ")});`);
    return lines.join("\n");
  }

  function cRatio(value) {
    const [numerator, denominator] = canwright.rational(value);
    return `{${numerator}, ${denominator}u}`;
  }

  function python({ edition: { bindings }, message, decoded, parameters }) {
    const { python: name, dependsOnParameters } = bindings.messages[`${message.direction} ${message.command}`];
    const imports = new Set([name]);
    const hasValues = decoded.fields.every((field) => field.reason === null);
    const types = new Map(message.fields.map((field, i) => [field.name, typeOf(bindings, message, i)]));
    const items = message.nodes ? [`node=${decoded.node}`] : []; // otherwise a field contains it
    for (const { name: field, raw, value } of decoded.fields) {
      const enumeration = types.get(field);
      const one = hasValues ? pythonValue(value, enumeration, imports) : pythonNumber(raw);
      items.push(`${own(bindings.attributes, field) ?? field}=${one}`);
    }
    const given = named(parameters, bindings);
    if (given.length && (dependsOnParameters || !hasValues)) {
      imports.add("Parameters");
      const known = given.map(([, value, one]) => {
        if (one.class) {
          imports.add(one.class);
        }
        return `${one.python}=${one.values ? one.values[value].python : pythonRatio(value)}`;
      });
      items.push(`parameters=Parameters(${known.join(", ")})`);
    }
    const call = hasValues ? name : `${name}.from_raw`;
    const fraction = items.some((item) => item.includes("Fraction(")) ? "from fractions import Fraction\n" : "";
    return [
      `${fraction}from ${bindings.module} import ${[...imports].sort().join(", ")}`,
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

  function typeOf(bindings, message, position) {
    return bindings.enums[bindings.fieldTypes[message.layout][position]] ?? null;
  }

  function pythonValue(value, enumeration, imports) {
    if (Array.isArray(value) && !enumeration) {
      return `[${value.map((one) => pythonValue(one, null, imports)).join(", ")}]`;
    }
    if (!enumeration) {
      return pythonNumber(value);
    }
    imports.add(enumeration.class);
    if (Array.isArray(value) && enumeration.isFlags) {
      return value.map((name) => enumeration.members[name]).join(" | ") || `${enumeration.class}(0)`;
    }
    return Array.isArray(value) ? `[${value.map((name) => enumeration.members[name]).join(", ")}]` : enumeration.members[value];
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
