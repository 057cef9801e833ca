-- Decides on the direction of each frame of a bus, in the order of the capture.
--
-- The rules, in this order: a mark of the recorder; the id or the content, if only one direction has it; pairing: a reply
-- within a time closes the exchange that a request opened; retry: the bytes of an open request again.
--
-- The first frames of a bus show how it behaves: whether each request is captured twice, whether the host leaves old bytes
-- in reserved bits of a request, and how long replies take. Each time that something is learned, they are decided again.

local codec = ...

local directions = {}

local MAX_OPEN = 64
local LEARNED_FROM = 4096
-- Times in ns: of a copy after its frame, and the longest time in which a late reply is searched for.
local COPIED_WITHIN, LONGEST = 3000000, 200000000
-- Shares are taken from so many cases. Old bits count if one frame in so many shows them.
local LEAST, RARE = 8, 32
-- Retries look like copies, and missing requests like slow replies, in a few cases.
local LEAST_IN_ALL = 32
local LATENCIES = 64
-- So many times, at most, the first frames are decided again.
local MAX_ROUNDS = 32

-- The state of all buses. `window` is the maximum time in ns in which a request is answered.
function directions.new(window)
    return { window = window, buses = {} }
end

local function new_bus(learned)
    return { open = {}, clock = 0, marks = {}, latest = {}, learned = learned }
end

-- What is known of a bus, and what it is learned from.
local function new_learned()
    return {
        history = {}, old = {}, runs = {}, replies = {}, latencies = {}, count = 0, certain = 0, unexpected = 0, rounds = 0,
        request_runs = 0, request_pairs = 0, all_runs = 0, all_pairs = 0,
    }
end

local function bus_of(state, name)
    local bus = state.buses[name]
    if not bus then
        bus = new_bus(new_learned())
        state.buses[name] = bus
    end
    return bus
end

-- Advances the clock of a bus; a time that jumps back counts as the same time. Times are {seconds, ns}.
local function advance(bus, time)
    local last = bus.time
    if last then
        local passed = (time[1] - last[1]) * 1000000000 + time[2] - last[2]
        if passed > 0 then
            bus.clock = bus.clock + passed
        end
    end
    bus.time = time
end

-- What a frame can be: the request, the replies that identify themselves, and those that only a request explains.
local function candidates(edition, frame)
    local request, request_found = codec.identify(edition, "requests", frame)
    local reply, reply_found = codec.identify(edition, "replies", frame)
    local replies = { reply }
    for _, answer in ipairs(edition.explained) do
        if answer ~= reply and codec.is_message(answer, frame) then
            replies[#replies + 1] = answer
        end
    end
    return {
        request = request,
        request_node = request and request_found,
        request_reason = not request and request_found or nil,
        reply = reply,
        reply_node = reply and reply_found,
        reply_reason = not reply and reply_found or nil,
        replies = replies,
    }
end

local function has_constants(messages, frame)
    for _, message in ipairs(messages) do
        if codec.has_constants(message, frame) then
            return true
        end
    end
    return false
end

local function is_same(first, second)
    if first[0] ~= second[0] or first.length ~= second.length then
        return false
    end
    for index = 1, first.length do
        if first[index] ~= second[index] then
            return false
        end
    end
    return true
end

-- The time in which a request is answered, at most: that of the user, of the command, or longer if replies take longer.
local function window_of(state, bus, request)
    local window = math.max(state.window, 2 * (bus.learned.reply_time or 0))
    return math.max(window, request and request.answer.reply_within or 0)
end

-- The oldest open exchange that a frame closes, its number, and the node that replies. Older ones than `longest` have ended.
local function answered(state, bus, edition, frame, longest)
    for number, exchange in ipairs(bus.open) do
        local window = longest or window_of(state, bus, exchange.request)
        if exchange.edition == edition and exchange.since + window >= bus.clock then
            local fits, node = codec.answers(exchange.request, exchange.node, exchange.frame, frame)
            if fits and not (node and exchange.answered[node]) then
                return exchange, number, node
            end
        end
    end
    return nil
end

-- Whether a program can send a request. Its reserved bits are those of the spec, or the old ones of its host.
local function is_regular(bus, request, frame)
    local old = bus.learned.old[request]
    local bits, is_zero = codec.reserved_bits(request, frame)
    if old then
        is_zero = old.value == nil or old.value == bits
    end
    return is_zero and codec.is_in_range(request, frame)
end

-- The direction by content; nil if both directions are possible.
local function by_content(bus, possible, frame)
    local is_request = possible.request ~= nil and codec.has_constants(possible.request, frame)
    local is_reply = has_constants(possible.replies, frame)
    if is_request and is_reply then
        if not is_regular(bus, possible.request, frame) then
            return "reply", "content"
        end
        return nil
    end
    if is_request then
        return "request", "content"
    end
    if is_reply then
        return "reply", "content"
    end
    return "unknown", "none"
end

-- Whether a reply to a request rarely has its bytes: it has another layout than the fields of the request.
local function replies_differ(request)
    return not request.answer.echo and #request.layout.fields > 0 and request.layout ~= request.answer.reply.layout
end

-- The time in which a reply is expected: of the command; twice that of the spec; of the log if replies take longer.
local function within(state, bus, edition, request)
    if request.answer.reply_within then
        return request.answer.reply_within
    end
    local window, usual = window_of(state, bus, request), bus.learned.reply_time or 0
    local stated = edition.reply_within and 2 * edition.reply_within
    if usual > (stated or state.window) then
        return math.min(window, usual * 1.5)
    end
    return math.min(window, stated or state.window / 4)
end

-- The direction of a frame that can be both.
local function by_exchange(state, bus, edition, possible, exchange, frame)
    if not exchange then
        return "request", "pairing"
    end
    local old = bus.learned.old[possible.request]
    local has_old = old ~= nil and old.value == nil
    local repeated, distinct = is_same(exchange.frame, frame), possible.request.answer.distinct and not has_old
    local soon = bus.clock - exchange.since <= within(state, bus, edition, exchange.request)
    if repeated and (not soon or distinct and replies_differ(exchange.request)) then
        return "request", "retry"
    end
    return (soon or not distinct and not has_old) and "reply" or "request", "pairing"
end

-- Opens an exchange. It replaces earlier ones of the same request, except echoes of other bytes.
local function open(bus, exchange)
    for number = #bus.open, 1, -1 do
        local earlier = bus.open[number]
        local is_to_same = earlier.frame[0] == exchange.frame[0] and earlier.node == exchange.node
        if earlier.request == exchange.request and is_to_same then
            if not exchange.request.answer.echo or is_same(earlier.frame, exchange.frame) then
                table.remove(bus.open, number)
            end
        end
    end
    if #bus.open == MAX_OPEN then
        table.remove(bus.open, 1)
    end
    bus.open[#bus.open + 1] = exchange
end

local function is_share(count, of, numerator, denominator)
    return of >= LEAST and count * denominator >= of * numerator
end

-- The reply time in which nine of ten replies come.
local function learn_latency(learned, edition, latency)
    if not edition.reply_within then
        return -- without a time in the spec, slow replies look like wrong pairs
    end
    learned.latencies[learned.count % LATENCIES + 1] = latency
    learned.count = learned.count + 1
    if learned.count % LEAST == 0 then
        local sorted = {}
        for number, time in ipairs(learned.latencies) do
            sorted[number] = time
        end
        table.sort(sorted)
        learned.reply_time = sorted[math.floor(#sorted * 9 / 10) + 1]
    end
end

-- Counts runs of equal frames of a node, and those with two frames for each.
local function learn_copies(bus, key, possible, frame, result)
    local learned, run = bus.learned, bus.learned.runs[key]
    if run and is_same(run.frame, frame) and bus.clock - run.clock <= COPIED_WITHIN then
        run.length, run.clock = run.length + 1, bus.clock
        return false
    end
    if run then
        local pair = run.length % 2 == 0 and 1 or 0
        learned.all_runs, learned.all_pairs = learned.all_runs + 1, learned.all_pairs + pair
        if run.direction == "request" then
            learned.request_runs, learned.request_pairs = learned.request_runs + 1, learned.request_pairs + pair
        end
    end
    local is_echo = possible.request ~= nil and possible.request.answer.echo
    learned.runs[key] = result.message and not is_echo
        and { frame = frame, clock = bus.clock, length = 1, direction = result.direction } or nil
    local is_enough = learned.all_runs >= LEAST_IN_ALL and not learned.copied
    if is_enough and (is_share(learned.request_pairs, learned.request_runs, 3, 4)
        or is_share(learned.all_pairs, learned.all_runs, 3, 8)) then
        learned.copied = true
        return true
    end
    return false
end

-- The most frequent reserved bits of replies without a request, if they are those of the request: half of them have these,
-- and others follow.
local function constant_bits(request, replies)
    local value, count, second = nil, 0, 0
    for bits, number in pairs(replies.bits) do
        if number > count then
            value, count, second = bits, number, count
        elseif number > second then
            second = number
        end
    end
    local is_usual = 3 * count >= replies.orphans and 2 * second < count and 2 * (replies.changes[value] or 0) >= count
    local is_request = #request.layout.fields > 0 or 2 * (replies.seconds[value] or 0) < count
    return not request.answer.echo and is_usual and is_request and value or nil
end

-- Counts replies by content that answer no request: two in a row can be a request with old bits and its reply.
local function learn_old_bits(bus, edition, key, request, frame, is_orphan)
    local learned = bus.learned
    local replies = learned.replies[request]
    if not replies then
        replies = { count = 0, orphans = 0, pairs = 0, bits = {}, changes = {}, seconds = {}, last = {} }
        learned.replies[request] = replies
    end
    local bits = codec.reserved_bits(request, frame)
    local before = replies.last[key] or { clock = bus.clock - 5 * LONGEST, pause = 0, bits = "" }
    local pause = bus.clock - before.clock
    local is_change = is_orphan and before.is_orphan and (bits == before.bits) == request.answer.echo
    local is_second = is_change and not before.is_second and pause > 0 and 2 * pause < before.pause
    replies.count = replies.count + 1
    if is_orphan then
        replies.orphans = replies.orphans + 1
        replies.bits[bits] = (replies.bits[bits] or 0) + 1
        if is_change then
            replies.changes[before.bits] = (replies.changes[before.bits] or 0) + 1
        end
    end
    if is_second then
        replies.pairs = replies.pairs + 1
        replies.seconds[bits] = (replies.seconds[bits] or 0) + 1
        learn_latency(learned, edition, pause)
    end
    replies.last[key] = { clock = bus.clock, pause = pause, bits = bits, is_orphan = is_orphan, is_second = is_second }
    if learned.old[request] or replies.count % LEAST ~= 0 then
        return false
    end
    local value = is_share(replies.orphans, replies.count, 1, 4) and constant_bits(request, replies) or nil
    if value or is_share(replies.pairs, replies.count, 1, RARE) then
        learned.old[request] = { value = value }
        return true
    end
    return false
end

-- Learns from a result; whether it changes the results of earlier frames.
local function learn(state, bus, edition, possible, frame, result)
    local learned = bus.learned
    local key = tostring(result.node) .. (result.node and "" or " " .. frame[0])
    local changed = learn_copies(bus, key, possible, frame, result)
    local is_certain = result.rule == "content" or result.rule == "id" or result.rule == "mark"
    if result.direction ~= "reply" or not is_certain then
        return changed
    end
    local exchange = result.exchange
    learned.certain = learned.certain + 1
    learned.unexpected = learned.unexpected + (exchange and 0 or 1)
    local late = not exchange and answered(state, bus, edition, frame, LONGEST)
    if late and learned.certain >= LEAST_IN_ALL and is_share(learned.unexpected, learned.certain, 3, 4) then
        if not late.request.answer.reply_within and #late.request.answer.nodes == 0 then
            local before = learned.reply_time or 0
            learn_latency(learned, edition, bus.clock - late.since)
            changed = changed or (learned.reply_time or 0) > before
        end
    elseif exchange and #exchange.request.answer.nodes == 0 and not exchange.request.answer.reply_within and result.latency then
        learn_latency(learned, edition, result.latency)
    end
    local is_by_content = possible.request and result.rule == "content"
    if is_by_content and learn_old_bits(bus, edition, key, possible.request, frame, not exchange and not late) then
        changed = true
    end
    return changed
end

local function decide(state, bus, edition, only, frame, arrival)
    advance(bus, arrival.time)
    while bus.open[1] and bus.open[1].since + math.max(LONGEST, window_of(state, bus, bus.open[1].request)) < bus.clock do
        table.remove(bus.open, 1)
    end
    local possible = candidates(edition, frame)
    local exchange, number, source
    if #possible.replies > 0 then
        exchange, number, source = answered(state, bus, edition, frame)
    end
    local direction, rule
    if arrival.mark then
        bus.marks[arrival.mark] = true
    end
    if arrival.mark and (arrival.trusts_marks or (bus.marks.sent and bus.marks.received)) then
        rule = "mark"
        if arrival.mark == "sent" then
            direction = arrival.sent
        else
            direction = arrival.sent == "request" and "reply" or "request"
        end
    elseif only then
        direction, rule = only, "id"
    else
        direction, rule = by_content(bus, possible, frame)
        if not direction then
            direction, rule = by_exchange(state, bus, edition, possible, exchange, frame)
        end
    end
    local result = {
        direction = direction, rule = rule, frame = frame, edition = edition, is_first_pass = arrival.is_first_pass,
    }
    if direction == "reply" then
        result.reason = possible.reply_reason
        result.message, result.node = possible.reply, possible.reply_node
        if exchange then
            result.message, result.node = exchange.request.answer.reply, source
            if not source and #exchange.request.answer.nodes == 0 then
                result.node = exchange.node
            end
            result.exchange, result.latency = exchange, bus.clock - exchange.since
            exchange.replies[#exchange.replies + 1] = arrival.number
            if arrival.time[1] < exchange.time[1] then
                result.latency = nil
            end
            exchange.missing = exchange.missing - 1
            if source then
                exchange.answered[source] = true
            end
            if exchange.missing == 0 then
                table.remove(bus.open, number)
            end
        end
    else
        result.reason = possible.request_reason
        result.message, result.node = possible.request, possible.request_node
        if possible.request and possible.request.answer.reply and codec.has_constants(possible.request, frame) then
            result.opened = {
                request = possible.request,
                node = possible.request_node,
                frame = frame,
                edition = edition,
                since = bus.clock,
                time = arrival.time,
                missing = math.max(1, #possible.request.answer.nodes),
                answered = {},
                replies = {},
                number = arrival.number,
            }
            open(bus, result.opened)
        end
    end
    return result, possible
end

-- The result for the copy of a request that was captured before; nil if a frame is none.
local function copy_of(bus, frame, arrival)
    local latest = bus.learned.copied and bus.latest[frame[0]]
    bus.latest[frame[0]] = nil
    if not latest or not is_same(latest.frame, frame) then
        return nil
    end
    advance(bus, arrival.time)
    if bus.clock - latest.clock > COPIED_WITHIN then
        return nil
    end
    local first = latest.result
    return {
        direction = first.direction, rule = "copy", frame = frame, edition = first.edition,
        message = first.message, node = first.node, reason = first.reason,
    }
end

local function judge(state, bus, edition, only, frame, arrival)
    local copy = copy_of(bus, frame, arrival)
    if copy then
        copy.is_first_pass = arrival.is_first_pass
        return copy, false
    end
    local result, possible = decide(state, bus, edition, only, frame, arrival)
    -- A request with old bits that are not known yet looks like a reply.
    if result.direction == "request" or result.rule == "content" then
        bus.latest[frame[0]] = { frame = frame, clock = bus.clock, result = result }
    end
    return result, learn(state, bus, edition, possible, frame, result)
end

-- Decides on the first frames of a bus again, in the tables of their results.
local function decide_again(state, name)
    local known = state.buses[name].learned
    local changed = true
    while changed and known.rounds < MAX_ROUNDS do
        changed = false
        local learned = new_learned()
        learned.rounds = known.rounds + 1
        learned.history, learned.old, learned.copied = known.history, known.old, known.copied
        learned.reply_time = known.reply_time
        local bus = new_bus(learned)
        state.buses[name] = bus
        for _, past in ipairs(learned.history) do
            local result, is_new = judge(state, bus, past.edition, past.only, past.frame, past.arrival)
            for key in pairs(past.result) do
                past.result[key] = nil
            end
            for key, value in pairs(result) do
                past.result[key] = value
            end
            changed = changed or is_new
        end
        known = learned
    end
end

-- The result for a frame: `direction` ("request", "reply" or "unknown"), `rule`, `message`, `node`, `reason` without a
-- message, and for a reply the `exchange` that it closes with the `latency` in ns. `mark` is "sent", "received" or nil.
-- Marks count if `trusts_marks`, or once a bus has both. `sent` is the direction of sent frames.
-- `only` is the direction of all frames with this id, or nil. What later frames show can change an earlier result.
function directions.judge(state, edition, only, frame, arrival)
    local bus = bus_of(state, arrival.bus)
    local result, changed = judge(state, bus, edition, only, frame, arrival)
    local history = bus.learned.history
    if history then
        history[#history + 1] = { result = result, edition = edition, only = only, frame = frame, arrival = arrival }
        if changed then
            decide_again(state, arrival.bus)
        elseif #history >= LEARNED_FROM then
            bus.learned.history = nil
        end
    end
    return result
end

return directions
