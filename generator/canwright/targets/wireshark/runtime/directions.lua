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

-- The state of all buses. `window` is the maximum time in ns in which a request is answered. Marks count if `trusts_marks`,
-- or once a bus has both. `sent` is the direction of sent frames, by default "request".
function directions.new(window, sent, trusts_marks)
    return {
        window = window, sent = sent or "request", trusts_marks = trusts_marks, buses = {}, verdicts = {},
        possible = { replies = {} },
    }
end

local function child(parent, key)
    local found = parent[key]
    if not found then
        found = {}
        parent[key] = found
    end
    return found
end

-- What many results have in common is one table, so that a million results take little memory.
local function set_verdict(state, result, direction, rule, message, node, reason)
    local verdict = child(child(child(child(state.verdicts, message or reason), direction), rule), node or false)
    verdict.direction, verdict.rule, verdict.message, verdict.node, verdict.reason = direction, rule, message, node, reason
    verdict.__index = verdict
    setmetatable(result, verdict)
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

-- Advances the clock of a bus to a time in ns; one that jumps back counts as the same time.
local function advance(bus, time)
    if bus.time and time > bus.time then
        bus.clock = bus.clock + time - bus.time
    end
    bus.time = time
end

-- What a frame can be: the request, the replies that identify themselves, and those that only a request explains. The table
-- is filled again for the next frame.
local function candidates(state, edition, frame)
    local possible, found = state.possible, nil
    possible.request, found = codec.identify(edition, "requests", frame)
    possible.request_node, possible.request_reason = possible.request and found, not possible.request and found or nil
    possible.reply, found = codec.identify(edition, "replies", frame)
    possible.reply_node, possible.reply_reason = possible.reply and found, not possible.reply and found or nil
    local replies, count = possible.replies, 0
    if possible.reply then
        replies[1], count = possible.reply, 1
    end
    for _, answer in ipairs(edition.explained) do
        if answer ~= possible.reply and codec.is_message(answer, frame) then
            count = count + 1
            replies[count] = answer
        end
    end
    for number = count + 1, #replies do
        replies[number] = nil
    end
    return possible
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
    return math.max(state.window, 2 * (bus.learned.reply_time or 0), request.answer.reply_within or 0)
end

-- The oldest open exchange that a frame closes, its number, the node that replies, and the reply that the frame is. Older
-- exchanges than `longest` have ended.
local function answered(state, bus, edition, frame, longest)
    for number, exchange in ipairs(bus.open) do
        local window = longest or window_of(state, bus, exchange.request)
        if exchange.edition == edition and exchange.since + window >= bus.clock then
            local answer, node = codec.answer(exchange.request, exchange.node, exchange.frame, frame)
            local already = node and exchange.answered and exchange.answered[node] or 0
            if answer and (not node or already < exchange.request.frames) then
                return exchange, number, node, answer
            end
        end
    end
    return nil
end

-- Whether a program can send a request. Its reserved bits are those of the spec, or the old ones of its host.
local function is_regular(bus, request, frame)
    local old = bus.learned.old[request]
    local has_usual_bits
    if old then
        has_usual_bits = old.value == nil or old.value == codec.reserved_bits(request, frame)
    else
        has_usual_bits = codec.has_regular_bits(request, frame)
    end
    return has_usual_bits and codec.is_in_range(request, frame)
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
    if result.message and not is_echo then
        run = child(learned.runs, key)
        run.frame, run.clock, run.length, run.direction = frame, bus.clock, 1, result.direction
    else
        learned.runs[key] = nil
    end
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
    local before = replies.last[key]
    if not before then
        before = { clock = bus.clock - 5 * LONGEST, pause = 0, bits = "" }
        replies.last[key] = before
    end
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
    before.clock, before.pause, before.bits, before.is_orphan, before.is_second = bus.clock, pause, bits, is_orphan, is_second
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

-- Learns from a result, and for a reply from the exchange that it closes; whether it changes the results of earlier frames.
local function learn(state, bus, edition, possible, frame, result, exchange)
    local learned = bus.learned
    local key = result.node or -1 - frame[0]
    local changed = learn_copies(bus, key, possible, frame, result)
    local is_certain = result.rule == "content" or result.rule == "id" or result.rule == "mark"
    if result.direction ~= "reply" or not is_certain then
        return changed
    end
    learned.certain = learned.certain + 1
    learned.unexpected = learned.unexpected + (exchange and 0 or 1)
    local late = not exchange and answered(state, bus, edition, frame, LONGEST)
    if late and learned.certain >= LEAST_IN_ALL and is_share(learned.unexpected, learned.certain, 3, 4) then
        if not late.request.answer.reply_within and #late.request.answer.nodes == 0 then
            local before = learned.reply_time or 0
            learn_latency(learned, edition, bus.clock - late.since)
            changed = changed or (learned.reply_time or 0) > before
        end
    elseif exchange and #exchange.request.answer.nodes == 0 and exchange.request.frames == 1 and not exchange.request.answer.reply_within and result.latency then
        learn_latency(learned, edition, result.latency)
    end
    local is_by_content = possible.request and result.rule == "content"
    if is_by_content and learn_old_bits(bus, edition, key, possible.request, frame, not exchange and not late) then
        changed = true
    end
    return changed
end

-- Fills the result for a frame; what the frame can be, and the exchange that it closes.
local function decide(state, bus, edition, only, frame, result)
    advance(bus, frame.time)
    while bus.open[1] and bus.open[1].since + math.max(LONGEST, window_of(state, bus, bus.open[1].request)) < bus.clock do
        table.remove(bus.open, 1)
    end
    local possible = candidates(state, edition, frame)
    local exchange, number, source, answer
    if #possible.replies > 0 then
        exchange, number, source, answer = answered(state, bus, edition, frame)
    end
    local direction, rule
    if frame.mark then
        bus.marks[frame.mark] = true
    end
    if frame.mark and (state.trusts_marks or (bus.marks.sent and bus.marks.received)) then
        rule = "mark"
        if frame.mark == "sent" then
            direction = state.sent
        else
            direction = state.sent == "request" and "reply" or "request"
        end
    elseif only then
        direction, rule = only, "id"
    else
        direction, rule = by_content(bus, possible, frame)
        if not direction then
            direction, rule = by_exchange(state, bus, edition, possible, exchange, frame)
        end
    end
    if direction ~= "reply" then
        local request = possible.request
        set_verdict(state, result, direction, rule, request, possible.request_node, possible.request_reason)
        if request and request.answer.reply and not codec.rejects(request, frame) then
            local missing = math.max(1, #request.answer.nodes) * request.frames
            result.expects_reply = true
            open(bus, {
                request = request,
                node = possible.request_node,
                frame = frame,
                edition = edition,
                since = bus.clock,
                missing = missing,
                answered = missing > 1 and {} or nil,
                result = result,
            })
        end
        return possible
    end
    if not exchange then
        set_verdict(state, result, direction, rule, possible.reply, possible.reply_node, possible.reply_reason)
        return possible
    end
    if source and exchange.answered then
        exchange.answered[source] = (exchange.answered[source] or 0) + 1
    elseif not source and #exchange.request.answer.nodes == 0 then
        source = exchange.node
    end
    set_verdict(state, result, direction, rule, answer.reply, source)
    result.request = exchange.frame.number
    if frame.time >= exchange.frame.time then
        result.latency = bus.clock - exchange.since
    end
    exchange.result[#exchange.result + 1] = frame.number
    exchange.missing = answer.frames == 0 and 0 or exchange.missing - 1
    if exchange.missing == 0 then
        table.remove(bus.open, number)
    end
    return possible, exchange
end

-- Whether a frame is the copy of a request that was captured before; its result then has the verdict of the request.
local function is_copy(state, bus, frame, result)
    local latest = bus.latest[frame[0]]
    bus.latest[frame[0]] = nil
    if not latest or not is_same(latest.frame, frame) then
        return false
    end
    advance(bus, frame.time)
    if bus.clock - latest.clock > COPIED_WITHIN then
        return false
    end
    local first = latest.result
    set_verdict(state, result, first.direction, "copy", first.message, first.node, first.reason)
    return true
end

-- Fills the result for a frame; whether it changes the results of earlier frames.
local function judge(state, bus, edition, only, frame, result)
    if bus.learned.copied and is_copy(state, bus, frame, result) then
        return false
    end
    local possible, exchange = decide(state, bus, edition, only, frame, result)
    -- A request with old bits that are not known yet looks like a reply.
    if bus.learned.copied and (result.direction == "request" or result.rule == "content") then
        bus.latest[frame[0]] = { frame = frame, clock = bus.clock, result = result }
    end
    return learn(state, bus, edition, possible, frame, result, exchange)
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
            for key in pairs(past.result) do
                past.result[key] = nil
            end
            local is_new = judge(state, bus, past.edition, past.only, past.frame, past.result)
            changed = changed or is_new
        end
        known = learned
    end
end

-- The result for a frame: `direction` ("request", "reply" or "unknown"), `rule`, `message`, `node` and `reason` without a
-- message. That of a reply has the number of its `request` and the `latency` in ns; that of a request which
-- `expects_reply` lists the numbers of its replies. What later frames show can change an earlier result.
-- `only` is the direction of all frames with this id, or nil.
function directions.judge(state, name, edition, only, frame)
    local bus, result = bus_of(state, name), {}
    local changed = judge(state, bus, edition, only, frame, result)
    local history = bus.learned.history
    if history then
        history[#history + 1] = { result = result, edition = edition, only = only, frame = frame }
        if changed then
            decide_again(state, name)
        elseif #history >= LEARNED_FROM then
            bus.learned.history = nil
        end
    end
    return result
end

return directions
