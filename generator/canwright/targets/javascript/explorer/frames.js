"use strict";

/** Reads frames from texts: lines of cansend, candump, ASC and their logs, tables, or what people paste; writes them as cansend does. */
canwright.frames = (() => {
  const CANSEND = /(?:^|\s)(?:0x)?([0-9A-Fa-f]{3}|[0-9A-Fa-f]{8})\s*#(?:#[0-9A-Fa-f])?\s*(R\d?|(?:[0-9A-Fa-f]{2}[\s.]*)*)(?=\s|$)/;
  const CANDUMP = /(?:^|\s)([0-9A-Fa-f]{3}|[0-9A-Fa-f]{8})\s+\[(\d+)\]\s*(remote request|(?:[0-9A-Fa-f]{2}(?:\s+|$))*)/i;
  const ASC = /^\s*(\d+\.\d+)\s+\w+\s+([0-9A-Fa-f]{1,8})(x?)\s+(Rx|Tx)\s+(?:(r)|d\s+([0-9A-Fa-f])((?:\s+[0-9A-Fa-f]{2})*))(?=\s|$)/;
  const BYTES = /^\s*(?:0x)?([0-9A-Fa-f]{3}|[0-9A-Fa-f]{8})[\s,;:]+((?:(?:0x)?(?:[0-9A-Fa-f]{2})+[\s,;]*)+)$/i;
  const MARK = /(?:^|\s)(TX|RX|T|R)(?=\s|$)/;
  const TIME = /^\s*\(([^)]*)\)/;
  const FD_LENGTHS = [12, 16, 20, 24, 32, 48, 64];

  // Lines of other logs: slcan; PCAN, whose lines have a number, a time and perhaps a type and a bus
  const SLCAN = /^\s*(?:t([0-9A-F]{3})|T([0-9A-F]{8}))([0-8])((?:[0-9A-F]{2})*)$/;
  const PCAN = /^\s*\d+\)?\s+\d+\.\d+\s+(?:[A-Z]{2}\s+)?(?:\d+\s+)?(?:([0-9A-F]{4,8})\s+)?(Rx|Tx)\s+(?:([0-9A-F]{4,8})\s+)?(?:-\s+)?(\d+)((?:\s+[0-9A-F]{2})*)\s*$/;

  // Error frames: of candump, whose ids have bit 29; of ASC; of PCAN; as python-can prints them
  const ERROR = /(?:^|\s)[23][0-9A-F]{7}(?:#|\s+\[)|error ?frame|错误帧|^\s*\d+\)?\s+\d+\.\d+\s+(?:\d+\s+)?(?:ER|Error)\b|\sE\s.*\bDLC?:/i;

  // Names of the columns of a table
  const COLUMNS = {
    time: /^time|时间/,
    id: /^(?:can[ _]?|arbitration_|message[ _]?|帧)?id(?:entifier|号|\s?[(（]\D*)?$|^标识符$/,
    extended: /^(?:is_)?ext/,
    remote: /remote|rtr/,
    error: /^(?:is_)?error/,
    length: /^(?:dlc|len)|长度/,
    data: /^(?:(?:d|b|byte)[ _]?[01]|(?:data|payload|数据)[ _]?[01]?)(?:\s?[(（]\D*)?$/,
  };
  const BASE64 = /^(?:[a-z\d+/]{4})*(?:[a-z\d+/]{2}==|[a-z\d+/]{3}=)?$/i;

  // Notations that people paste
  const WIDE = /[\uff01-\uff5e]/g; // full-width characters
  const MARKED = /\\x(?=[0-9A-F]{2})|(?<=\b[0-9A-F]{2,8})h\b|(?<=\b[0-9A-F]{2})-(?=[0-9A-F]{2}\b)|\bb(?=['"])/gi; // of strings, assemblers and tools
  const DUMP = /^\s*(?:0{4,8}:?|[0-9A-F]{4,8}(?=.*\|))\s+((?:[0-9A-F]{2} {0,2})+)(?:\s*\|.*|\s{2,}\S.{0,16})?$/i;
  const LIST = /[{[]([^{}[\]]*[^{}[\]\d\s][^{}[\]]*)[}\]]/; // of C, Python or JSON; `[8]` is a length
  const ID_LABEL = /(?:^|[^a-z])(?:id|标识符)["']?\s*[:=]?\s*["']?(?:0x)?([0-9a-f]+)h?(?![0-9a-z_])/di;
  const LENGTH_LABEL = /(?:^|[^a-z])(?:dlc|dl|len|length|长度)["']?\s*[:=]?\s*(\d+)/di;
  const DATA_LABEL = /(?:data|payload|bytes|buffer|buf|数据)["']?\s*(?:\[\d*\])?\s*[:=]|数据\s/i;
  const STANDARD = /标准|\bst(?:d|andard)\b|\bfalse\b/i; // `false` is in the column for extended ids
  const EXTENDED = /扩展|\bext(?:ended)?\b(?!["']?\s*[:=]\s*(?:0|false)\b)|\sX\s/i;
  const TOKEN = /[^\s,;:=|"'(){}[\]<>]+/g;
  const BYTE = /^(?:0x)?[0-9a-f]{2}$/i;
  const SHORT_BYTE = /^(?:0x)?[0-9a-f]{1,2}$/i; // programs of microcontrollers print no leading zero
  const ID = /^(?:0x)?(?:[0-9a-f]{3}|0[0-7][0-9a-f]{2}|[0-9a-f]{8})$|^0x[0-9a-f]+$/i;
  const WORD = /^[dsx-]$|^(?=.*[^0-9a-f])\D{2,}\d*$/i;
  const AFTER = /(?<=\s(?:0x)?[0-9a-f]{1,2}\s+)\d+\.\d+\s+[RT]\s*$|\s'[^']*'\s*$/i; // a time with a direction, characters
  const ASSIGNED = /\[\d+\]\s*=\s*(0x[0-9a-f]{1,2}|\d+)\b/gi; // a byte of an array
  const STRING = /(?:bytearray\()?\bb(?:'((?:\\.|[^\\'])*)'|"((?:\\.|[^\\"])*)")/i; // bytes of Python
  const ESCAPES = { n: 10, r: 13, t: 9 };

  const numbers = (digits) => (digits.match(/[0-9A-Fa-f]{2}/g) ?? []).map((byte) => parseInt(byte, 16));

  /** The frame of a line of a log with `time` and `sent` (true, false, or null if unknown); null for a line without one. */
  function parseLine(line) {
    const frame = recorded(line);
    return frame && !damage(frame) ? frame : null;
  }

  function recorded(line) {
    const asc = ASC.exec(line);
    const plain = BYTES.exec(line);
    return asc ? fromAsc(asc) : plain ? fromBytes(plain) : (fromCandump(line) ?? fromSlcan(line) ?? fromPcan(line));
  }

  /** What is wrong with a frame, as a label with its value; null if nothing is. */
  function damage({ id, data, extended }) {
    if (id > (extended ? 2 ** 29 - 1 : 0x7ff)) {
      return ["bad_id", hex(id, 3)];
    }
    return data.length > 8 && !FD_LENGTHS.includes(data.length) ? ["bad_length", data.length] : null;
  }

  function fromAsc([, time, id, extended, mark, remote, length, digits = ""]) {
    const data = numbers(digits);
    const isWhole = remote || data.length === parseInt(length, 16);
    return isWhole ? { id: parseInt(id, 16), data, extended: extended !== "", remote: Boolean(remote), time, sent: mark === "Tx" } : null;
  }

  function fromBytes([, id, digits]) {
    return { id: parseInt(id, 16), data: numbers(digits.replace(/0x/gi, "")), extended: id.length === 8, remote: false, time: "", sent: null };
  }

  /** A line of slcan, which can end with a time of two bytes. */
  function fromSlcan(line) {
    const [, id, long, length, digits] = SLCAN.exec(line) ?? [];
    const excess = digits?.length - 2 * length;
    return excess === 0 || excess === 4 ? pasted(parseInt(id ?? long, 16), numbers(digits).slice(0, length), !id) : null;
  }

  function fromPcan(line) {
    const [, before, mark, after, length, digits] = PCAN.exec(line) ?? [];
    const id = before ?? after;
    const data = numbers(digits ?? "");
    return id && data.length === Number(length) ? pasted(parseInt(id, 16), data, id.length === 8, mark === "Tx") : null;
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
    const data = (short ? match[2] : match[3]).replace(/[\s.]/g, "");
    const remote = short ? data.startsWith("R") : /^remote/i.test(data);
    const bytes = remote ? [] : numbers(data);
    if (long && !remote && bytes.length !== Number(match[2])) {
      return null;
    }
    const mark = MARK.exec(rest.replace(whole, " "))?.[1] ?? MARK.exec(rest.slice(0, match.index))?.[1];
    return { id: parseInt(digits, 16), data: bytes, extended: digits.length === 8, remote, time, sent: mark ? mark.startsWith("T") : null };
  }

  /**
   * A text as people paste it: a line of a log, or bytes with or without an id in another notation.
   * `{ frame }`, whose id is null if the text has none, or `{ problem }`: a label, the column and further values.
   */
  function parse(text) {
    const blank = (mark) => " ".repeat(mark.length);
    const narrow = text.replace(WIDE, (character) => String.fromCharCode(character.charCodeAt(0) - 0xfee0)).replace(/[\u3000、]/g, " ");
    const line = narrow.replace(STRING, (_, single, double) => bytesOf(single ?? double)).replace(MARKED, blank).replace(AFTER, blank);
    const assigned = [...line.matchAll(ASSIGNED)].map(([, value]) => Number(value));
    if (assigned.length > 1 && assigned.every((value) => value < 256)) {
      const label = ID_LABEL.exec(line);
      return { frame: pasted(label && parseInt(label[1], 16), assigned) };
    }
    const dump = DUMP.exec(line);
    const frame = dump ? pasted(null, numbers(dump[1])) : parseLine(line);
    const rest = frame && !dump && line.includes("#") ? strayAfterHash(line) : null;
    return rest ? { problem: rest } : frame ? { frame } : line.includes("#") ? { problem: wrongDigits(line) } : fromTokens(line);
  }

  /** The bytes of a string of Python in hexadecimal. */
  function bytesOf(content) {
    const parts = content.match(/\\x[0-9a-f]{2}|\\.|[^\\]/gis) ?? [];
    const value = (part) => (/^\\x/.test(part) ? parseInt(part.slice(2), 16) : (ESCAPES[/^\\(.)/.exec(part)?.[1]] ?? part.at(-1).charCodeAt(0)));
    return parts.map((part) => hex(value(part), 2)).join(" ");
  }

  function pasted(id, data, extended = false, sent = null) {
    return { id, data, extended, remote: false, time: "", sent };
  }

  /** What follows the bytes after `#`, apart from a direction and a comment. */
  function strayAfterHash(line) {
    const rest = /#(?:R\d?|#?[\s.\dA-F]*)(?=(.*))/i.exec(line)[1].replace(/^(?:TX|RX|T|R)?\s*/, "");
    return /^[^;/]/.test(rest) ? ["bad_byte", line.length - rest.length + 1, rest.split(/\s/)[0]] : null;
  }

  /** Why a line with `#` has no frame. */
  function wrongDigits(line) {
    const start = line.indexOf("#") + 1;
    const id = /(\S*)\s*#/.exec(line);
    const digits = line.slice(start).replace(/^#./, "  ");
    const wrong = digits.search(/[^0-9A-F\s.]/i);
    const last = digits.trimEnd().length;
    if (!/^(?:0x)?(?:[0-9A-F]{3}|[0-9A-F]{8})$/i.test(id[1]) || parseInt(id[1], 16) > (id[1].length > 5 ? 2 ** 29 - 1 : 0x7ff)) {
      return ["bad_id", id.index + 1, id[1]];
    }
    if (wrong >= 0) {
      return ["bad_byte", start + wrong + 1, digits[wrong]];
    }
    const count = digits.replace(/[\s.]/g, "").length;
    return count % 2 ? ["half_byte", start + last, digits[last - 1]] : ["bad_length", start + 1, count / 2];
  }

  /** A text without `#`: the bytes are in braces, behind a label, or at the end. */
  function fromTokens(line) {
    const label = ID_LABEL.exec(line);
    const length = LENGTH_LABEL.exec(line);
    const data = DATA_LABEL.exec(line);
    const braces = LIST.exec(line);
    const list = DATA_LABEL.test(braces?.[1]) ? null : braces;
    const tokens = (start, end) => [...line.slice(start, end).matchAll(TOKEN)].map(({ 0: token, index }) => ({ token, column: start + index + 1 }));
    const behind = data ? data.index + data[0].length : length && label ? length.indices[1][1] : null;
    const all = list ? tokens(list.index + 1, list.index + list[0].length - 1) : tokens(behind ?? 0, line.length);
    const region = behind === null && !list ? unlabelled(all) : { bytes: all };
    if (region.problem) {
      return region;
    }
    const isOfC = list && region.bytes.every(({ token }) => /^(?:0x[0-9a-f]{1,2}|0|[1-9]\d{0,2})u?$/i.test(token));
    const end = list ? -1 : region.bytes.findIndex(({ token }, i) => i > 0 && WORD.test(token));
    const bytes = end < 0 ? region.bytes : region.bytes.slice(0, end);
    const digit = (region.isShort || (behind !== null && bytes.length > 1)) && !list ? SHORT_BYTE : BYTE;
    const values = bytes.map(({ token }) => (isOfC ? Number(token.replace(/u$/i, "")) : digit.test(token) ? parseInt(token, 16) : NaN));
    const whole = bytes.length === 1 || region.isPacked ? bytes.map(({ token }) => token.replace(/^0x/i, "")).join("") : "";
    const content = /^(?:[0-9a-f]{2})+$/i.test(whole) ? numbers(whole) : values;
    const wrong = content.findIndex((value) => !(value < 256));
    if (!content.length) {
      return { problem: ["no_frame"] };
    }
    if (wrong >= 0) {
      return { problem: wrongToken(bytes[wrong]) };
    }
    const stated = length ? { token: length[1], column: length.indices[1][0] + 1 } : region.length;
    if (stated && Number(stated.token) !== content.length) {
      return { problem: ["bad_count", stated.column, Number(stated.token), content.length] };
    }
    const ahead = list ? tokens(0, list.index).findLast(({ token }) => /^0x[0-9a-f]+$/i.test(token)) : undefined;
    const id = label ? { token: label[1], column: label.indices[1][0] + 1 } : (region.id ?? ahead);
    const digits = id ? id.token.replace(/^0x/i, "") : "";
    const isDecimal = isOfC && bytes.some(({ token }) => /^\d{3}u?$/.test(token)) && !/0x/i.test(line); // as ROS prints messages
    const number = id ? parseInt(digits, isDecimal ? 10 : 16) : null;
    const frame = pasted(number, content, isExtended(line, digits, number), sentIn(line));
    const damaged = damage(frame);
    const column = damaged?.[0] === "bad_id" ? id.column : bytes[0].column;
    return damaged ? { problem: [damaged[0], column, damaged[1]] } : { frame };
  }

  function isExtended(line, digits, id) {
    const isLong = digits.length === 8 || (digits.length > 3 && id > 0x7ff);
    return EXTENDED.test(line) || (isLong && !STANDARD.test(line));
  }

  function sentIn(line) {
    return /\btx\b|发送/i.test(line) ? true : /\brx\b|接收/i.test(line) ? false : null;
  }

  function wrongToken({ token, column }) {
    const isHalf = /^[0-9a-f]+$/i.test(token) && token.length % 2;
    return isHalf ? ["half_byte", column + token.length - 1, token.at(-1)] : ["bad_byte", column, token];
  }

  /** The bytes at the end of some tokens, with the id and the length before them, between which there are only words and digits. */
  function unlabelled(tokens) {
    const counted = tokens.findIndex(({ token }, i) => ID.test(token) && tokens[i + 1]?.token === String(tokens.length - i - 2));
    if (counted >= 0 && tokens.slice(counted + 2).every(({ token }) => SHORT_BYTE.test(token))) {
      return { bytes: tokens.slice(counted + 2), id: tokens[counted], isShort: true };
    }
    while (tokens.length > 1 && tokens.at(-1).token.length > 1 && WORD.test(tokens.at(-1).token)) {
      tokens.pop();
    }
    const last = tokens.at(-1)?.token ?? "";
    const shortStart = startOf(tokens, ({ token }) => SHORT_BYTE.test(token));
    const isShort = isUnambiguous(tokens.slice(shortStart).map(({ token }) => token));
    const size = !isShort && (last.length > 4 || !BYTE.test(last)) ? last.length : 0;
    const isByte = ({ token }) => (size ? token.length === size && /^(?:0x)?(?:[0-9a-f]{2})+$/i.test(token) : BYTE.test(token));
    const start = isShort ? shortStart : startOf(tokens, isByte);
    const head = tokens.slice(0, start);
    const isCount = ({ token }) => /^0x0/i.test(token) && Number(token) === tokens.length - start;
    const ids = head.filter((each, i) => ID.test(each.token) && !(i > 1 && isCount(each)));
    const id = ids.findLast(({ token }) => /^0x/i.test(token)) ?? ids.at(-1);
    const between = id ? head.slice(head.indexOf(id) + 1) : head;
    const stray = between.find(({ token }) => !WORD.test(token) && !/^\d$/.test(token) && !(BYTE.test(token) && start < tokens.length));
    if (start === tokens.length || stray || (head.length && !id)) {
      const isOdd = /^[0-9a-f]+$/i.test(last) && last.length % 2 === 1 && (tokens.length > 1 || last.length > 3);
      const wrong = start < tokens.length ? stray : isOdd || tokens.some(({ token }) => BYTE.test(token)) ? tokens.at(-1) : null;
      return { problem: wrong ? wrongToken(wrong) : ["no_frame"] };
    }
    const bytes = tokens.slice(start);
    const isLength = bytes.length === 9 && id && bytes[0].token === "08"; // of a list of comma-separated values
    const length = isLength ? bytes.shift() : between.findLast(({ token }) => /^\d$/.test(token) && between.at(-1).token === token);
    return { bytes, id, length, isShort, isPacked: size > 0 };
  }

  /** Where the last tokens start that are all of a kind. */
  function startOf(tokens, isOfKind) {
    let start = tokens.length;
    while (start > 0 && isOfKind(tokens[start - 1])) {
      start -= 1;
    }
    return start;
  }

  /**
   * Whether tokens of one or two digits can only be bytes: the first is no length or channel, the last is not cut off,
   * and no number can be decimal.
   */
  function isUnambiguous(tokens) {
    const isShort = tokens.some((token, i) => /^0x.$/i.test(token) || (token.length === 1 && i < tokens.length - 1));
    const plain = tokens.filter((token) => !/^0x/i.test(token));
    return isShort && BYTE.test(tokens[0]) && (plain.some((token) => /[a-f]/i.test(token)) || !plain.some((token) => /^[1-9]\d$/.test(token)));
  }

  /**
   * Adds lines to a log: its frames with their marks, and how many other lines it has. `parseOne` returns the frame of a line, null
   * for a line without one, or false for an error frame.
   */
  function parseLines(lines, log, parseOne) {
    for (const line of lines.filter((each) => each.trim())) {
      const frame = !ERROR.test(line) && parseOne(line);
      if (frame) {
        log.frames.push(frame);
        log.marks.add(frame.sent);
      } else {
        log[frame === null ? "skipped" : "errors"] += 1;
      }
    }
  }

  /** Reads the lines of a table whose first line names its columns, as `parseLines` expects; null without an id and data. */
  function tableParser(header) {
    const separator = /[;\t]/.exec(header)?.[0] ?? ",";
    const cellsOf = (line) => line.split(separator).map((cell) => cell.replace(/"/g, "").trim());
    const names = cellsOf(header.toLowerCase());
    const at = Object.fromEntries(Object.entries(COLUMNS).map(([column, name]) => [column, names.findIndex((each) => name.test(each))]));
    const isSpread = /\d$/.test(names[at.data]) || at.data === names.length - 1; // bytes can have a cell each
    let form = null; // without lengths, the first line decides
    const bytesOf = (content, length) => {
      const forms = [
        /^(?:(?:0x)?[\da-f]{2}[\s.-]*)*$/i.test(content) && numbers(content.replace(/0x/gi, "")),
        names[at.id] === "arbitration_id" && BASE64.test(content) && Array.from(atob(content), (byte) => byte.charCodeAt(0)), // of python-can
      ];
      form ??= forms[0] ? 0 : forms[1] ? 1 : null;
      return length ? forms.find((bytes) => bytes && bytes.length === Number(length)) : forms[form];
    };
    const parseOne = (line) => {
      const cells = cellsOf(line);
      const cell = (column) => cells[at[column]] ?? "";
      const flag = (column) => /^(?:1|true|x)$/i.test(cell(column));
      if (flag("error")) {
        return false;
      }
      const digits = cell("id").replace(/^0x|h$/gi, "");
      const id = /^[\da-f]+$/i.test(digits) ? parseInt(digits, 16) : NaN;
      const length = cell("length");
      const content = isSpread ? cells.slice(at.data, at.data + (Number(length) || 64)).join(" ").trim() : cell("data");
      const data = flag("remote") ? [] : bytesOf(content, length);
      const extended = cell("extended") ? flag("extended") : isExtended(line, digits, id);
      return data && id >= 0 && !damage({ id, data, extended }) ? { id, data, extended, remote: flag("remote"), time: cell("time"), sent: sentIn(line) } : null;
    };
    return at.id < 0 || at.data < 0 ? null : parseOne;
  }

  /** The frame of a pasted line that has an id; null for another line. */
  function parsePasted(line) {
    const { frame } = parse(line);
    return frame && frame.id !== null ? frame : null;
  }

  function hex(value, digits) {
    return value.toString(16).toUpperCase().padStart(digits, "0");
  }

  function format({ id, data, extended, remote }) {
    return `${hex(id, extended ? 8 : 3)}${data.length > 8 ? "##0" : "#"}${remote ? "R" : data.map((byte) => hex(byte, 2)).join("")}`;
  }

  /** A frame with its direction, if that is known, as candump writes it. */
  function withMark(frame) {
    return format(frame) + (typeof frame.sent === "boolean" ? (frame.sent ? " T" : " R") : "");
  }

  return { parse, parseLine, parseLines, parsePasted, tableParser, format, withMark, hex };
})();
