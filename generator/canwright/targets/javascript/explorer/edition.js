"use strict";

/** The functions of an edition from its tables, which are a quarter of the statements that the package has of it. */
canwright.createEdition = (tables) => {
  const { Definition, Edition, MessageResult, checkChecksum, checkConstant, checksum, layoutsOf, required, typesOf, unknownCode, unusedBits, wrongLength, wrongMessage } = canwright;
  const layouts = layoutsOf(typesOf(tables.types), tables.layouts);
  const messages = tables.messages.map(definition);

  /** The integer in some bits of a frame; bytes beyond its data count as 0. */
  function bits({ id, data }, segments) {
    const part = ([byte, low, width, rawLow]) => BigInt.asUintN(width, BigInt(byte < 0 ? id : (data[byte] ?? 0)) >> BigInt(low)) << BigInt(rawLow);
    return segments.reduce((raw, segment) => raw | part(segment), 0n);
  }

  function write(frame, segments, raw) {
    for (const [byte, low, width, rawLow] of segments) {
      const part = Number(BigInt.asUintN(width, BigInt(raw) >> BigInt(rawLow))) << low;
      if (byte < 0) {
        frame.id |= part;
      } else {
        frame.data[byte] |= part;
      }
    }
  }

  function has(frame, { segments, values }) {
    return values.some((value) => BigInt(value) === bits(frame, segments));
  }

  /** The raw integer of a field, or those of its elements. */
  function rawIn(frame, { type, isArray, description: { elements } }) {
    const raws = elements.map((segments) => type.integer((type.encoding === "signed" ? BigInt.asIntN : BigInt.asUintN)(type.width, bits(frame, segments))));
    return isArray ? Object.freeze(raws) : raws[0];
  }

  function record(fields, content) {
    return Object.freeze(Object.fromEntries(fields.map((field) => [field.name, content(field)])));
  }

  function definition(about) {
    const { only = {}, keys = [], node, nodes, parameter, remote, length, checksum: table, confusions = [] } = about;
    const { every, parameter: choice } = layouts[about.layout];
    const compute = table && checksum(table);
    const computed = (frame) => compute(table.inputs.map((input) => (Array.isArray(input) ? Number(bits(frame, input)) : input)));
    const fixed = every.filter(({ description }) => description.isConstant && description.fixed !== null);
    const given = every.filter(({ description }) => description.isConstant && description.fixed === null);
    const sums = every.filter(({ description }) => description.isChecksum);

    function checkAll(frame, fields, parameters) {
      for (const field of fields) {
        const wanted = field.type.integer(field.description.fixed ?? required(parameters, field.description.parameter, field.name));
        [rawIn(frame, field)].flat().forEach((raw) => checkConstant(raw, wanted, field.name));
      }
    }

    return new Definition(layouts, about, {
      hasKeys: (frame) => keys.every((key) => has(frame, key)),
      nodeInData: node && ((frame) => Number(bits(frame, node))),
      check(frame) {
        checkAll(frame, fixed.filter(({ only: some }) => some === null));
        sums.forEach((field) => checkChecksum(rawIn(frame, field), computed(frame), field.name));
      },
      read(frame, id, parameters) {
        const fields = this.fields(parameters);
        checkAll(frame, [...fixed, ...given].filter((field) => field.exists(parameters[choice])), parameters);
        const raw = record(fields, (field) => rawIn(frame, field));
        const values = record(fields, ({ name, type, isArray }) => (isArray ? type.valueOfAll(raw[name], parameters) : type.value(raw[name], parameters)));
        return new MessageResult(this, id, parameters, frame, raw, values, keys[0]?.values.length > 1 ? Number(bits(frame, keys[0].segments)) : undefined);
      },
      write(content, parameters) {
        Object.entries(only).forEach(([name, values]) => content.checkAvailable(name, values));
        const code = content.codeOf(keys[0]?.values ?? []);
        if (nodes) {
          content.checkNode(...nodes);
        }
        if (parameter) {
          content.checkParameter(parameter);
        }
        const raw = content.raws(this.fields(parameters).map(({ name }) => name));
        const frame = content.frame(0, Array.from({ length: remote ? 0 : length }, () => 0));
        keys.forEach(({ segments, values }, i) => write(frame, segments, i ? values[0] : code));
        for (const { name, isValue, description } of every.filter((field) => field.exists(parameters[choice]) && !field.description.isChecksum)) {
          const written = isValue ? raw[name] : (description.fixed ?? required(parameters, description.parameter, name));
          description.elements.forEach((segments, i) => write(frame, segments, Array.isArray(written) ? written[i] : written));
        }
        sums.forEach(({ description }) => write(frame, description.elements[0], computed(frame)));
        const confusion = confusions.find(({ conditions }) => conditions.every((condition) => has(frame, condition)));
        if (confusion) {
          throw wrongMessage(this, confusion.command, frame);
        }
        return frame;
      },
    });
  }

  /** The message of a frame, or the error: a plan is the position of a message, a reason, or a decision; `path` are those before. */
  function identified(plan, direction, frame, path = []) {
    if (typeof plan === "number") {
      return messages[plan];
    }
    if (typeof plan === "string") {
      const lengths = () => path.findLast(({ on }) => on === "length").cases.flatMap(([values]) => values);
      const codes = () => path.filter(({ on }) => Array.isArray(on)).map(({ value }) => value);
      return { wrong_length: () => wrongLength(frame, lengths()), unknown_code: () => unknownCode(frame, direction, codes()), unknown_id: () => unusedBits(frame) }[plan]();
    }
    const { on, cases, otherwise } = plan;
    const value = on === "length" ? frame.data.length : Array.isArray(on) ? bits(frame, on) : frame.id & on.mask;
    const [, then] = cases.find(([values]) => values.some((one) => BigInt(one) === BigInt(value))) ?? [value, otherwise];
    return identified(then, direction, frame, [...path, { on, cases, value }]);
  }

  function routes(direction, each) {
    return each.map((rule) => ({ rule, message: (frame) => identified(rule.plan, direction, frame) }));
  }

  return new Edition({
    ...tables,
    messages,
    explained: tables.explained.map((position) => messages[position]),
    answers: tables.answers.map(({ request, reply }) => ({ request: messages[request], reply: messages[reply] })),
    requests: routes("request", tables.requests),
    replies: routes("reply", tables.replies),
  });
};
