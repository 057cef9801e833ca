"use strict";

/** Reads frames from texts: lines of cansend, candump, ASC and their logs, or id and bytes; writes them as cansend does. */
canwright.frames = (() => {
  const CANSEND = /(?:^|\s)(?:0x)?([0-9A-Fa-f]{3}|[0-9A-Fa-f]{8})#(R\d?|[0-9A-Fa-f.]*)(?=\s|$)/;
  const CANDUMP = /(?:^|\s)([0-9A-Fa-f]{3}|[0-9A-Fa-f]{8})\s+\[(\d+)\]\s*(remote request|(?:[0-9A-Fa-f]{2}(?:\s+|$))*)/i;
  const ASC = /^\s*(\d+\.\d+)\s+\w+\s+([0-9A-Fa-f]{1,8})(x?)\s+(Rx|Tx)\s+(?:(r)|d\s+([0-9A-Fa-f])((?:\s+[0-9A-Fa-f]{2})*))(?=\s|$)/;
  const BYTES = /^\s*(?:0x)?([0-9A-Fa-f]{3}|[0-9A-Fa-f]{8})[\s,;:]+((?:(?:0x)?(?:[0-9A-Fa-f]{2})+[\s,;]*)+)$/i;
  const MARK = /(?:^|\s)(TX|RX|T|R)(?=\s|$)/;
  const TIME = /^\s*\(([^)]*)\)/;

  const numbers = (digits) => (digits.match(/[0-9A-Fa-f]{2}/g) ?? []).map((byte) => parseInt(byte, 16));

  /** The frame of one line with `time` and `sent` (true, false, or null if unknown); null for a line without one. */
  function parseLine(line) {
    const asc = ASC.exec(line);
    const plain = BYTES.exec(line);
    const frame = asc ? fromAsc(asc) : plain ? fromBytes(plain) : fromCandump(line);
    const isDamaged = !frame || frame.data.length > canwright.MAX_DATA_BYTES || frame.id > (frame.extended ? 2 ** 29 - 1 : 0x7ff);
    return isDamaged ? null : frame;
  }

  function fromAsc([, time, id, extended, mark, remote, length, digits = ""]) {
    const data = numbers(digits);
    const isWhole = remote || data.length === parseInt(length, 16);
    return isWhole ? { id: parseInt(id, 16), data, extended: extended !== "", remote: Boolean(remote), time, sent: mark === "Tx" } : null;
  }

  function fromBytes([, id, digits]) {
    return { id: parseInt(id, 16), data: numbers(digits.replace(/0x/gi, "")), extended: id.length === 8, remote: false, time: "", sent: null };
  }

  function fromCandump(line) {
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
    const bytes = remote ? [] : numbers(data);
    if ((!remote && data.length % 2) || (long && !remote && bytes.length !== Number(match[2]))) {
      return null;
    }
    const mark = MARK.exec(rest.replace(whole, " "))?.[1] ?? MARK.exec(rest.slice(0, match.index))?.[1];
    return { id: parseInt(digits, 16), data: bytes, extended: digits.length === 8, remote, time, sent: mark ? mark.startsWith("T") : null };
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
