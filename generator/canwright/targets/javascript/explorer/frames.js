"use strict";

/** Reads frames from texts: lines of cansend, candump and its logs; writes them as cansend does. */
canwright.frames = (() => {
  const CANSEND = /(?:^|\s)([0-9A-Fa-f]{3}|[0-9A-Fa-f]{8})#(R\d?|[0-9A-Fa-f.]*)(?=\s|$)/;
  const CANDUMP = /(?:^|\s)([0-9A-Fa-f]{3}|[0-9A-Fa-f]{8})\s+\[(\d+)\]\s*(remote request|(?:[0-9A-Fa-f]{2}(?:\s+|$))*)/i;
  const MARK = /(?:^|\s)(TX|RX|T|R)(?=\s|$)/;
  const TIME = /^\s*\(([^)]*)\)/;

  /** The frame of one line with `time` and `sent` (true, false, or null if unknown); null for a line without one. */
  function parseLine(line) {
    const time = TIME.exec(line)?.[1].trim() ?? "";
    const rest = line.replace(TIME, " ");
    const short = CANSEND.exec(rest);
    const long = short ? null : CANDUMP.exec(rest);
    const match = short ?? long;
    if (!match) {
      return null;
    }
    const [whole, digits] = match;
    const data = short ? match[2].replaceAll(".", "") : match[3].replace(/\s/g, "");
    const remote = short ? data.startsWith("R") : /^remote/i.test(data);
    const bytes = remote ? [] : (data.match(/../g) ?? []).map((byte) => parseInt(byte, 16));
    const id = parseInt(digits, 16);
    const isDamaged = (!remote && data.length % 2) || bytes.length > 8 || id >= 2 ** 29 || (digits.length === 3 && id > 0x7ff);
    if (isDamaged || (long && !remote && bytes.length !== Number(match[2]))) {
      return null;
    }
    const mark = MARK.exec(rest.replace(whole, " "))?.[1] ?? MARK.exec(rest.slice(0, match.index))?.[1];
    return { id, data: bytes, extended: digits.length === 8, remote, time, sent: mark ? mark.startsWith("T") : null };
  }

  /** The frames of a log, one per line, and the number of lines that have none. */
  function parseLog(text) {
    const frames = [];
    let skipped = 0;
    for (const line of text.split(/\r?\n/)) {
      const frame = line.trim() ? parseLine(line) : undefined;
      if (frame) {
        frames.push(frame);
      } else if (frame === null) {
        skipped += 1;
      }
    }
    return { frames, skipped };
  }

  function hex(value, digits) {
    return value.toString(16).toUpperCase().padStart(digits, "0");
  }

  function format({ id, data, extended, remote }) {
    return `${hex(id, extended ? 8 : 3)}#${remote ? "R" : data.map((byte) => hex(byte, 2)).join("")}`;
  }

  return { parseLine, parseLog, format, hex };
})();
