-- Decides on the direction of each frame of a bus, in the order of the capture.
--
-- The rules, in this order: a mark of the recorder; the id or the content, if only one direction has it; pairing: a reply
-- within a time closes the exchange that a request opened; retry: the bytes of an open request again. Anything else is
-- assumed, and its rule says so. Nothing is learned from other frames: a result never changes.

local codec = ...

local directions = {}

local MAX_OPEN = 64

-- The state of all buses. `window` is the maximum time in ns in which a request is answered. Marks count if `trusts_marks`,
-- or once a node has both. `sent` is the direction of sent frames, by default "request".
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
    if not verdict.__index then
        verdict.direction, verdict.rule, verdict.message, verdict.node, verdict.reason = direction, rule, message, node, reason
        verdict.__index = verdict
    end
    setmetatable(result, verdict)
end

local function bus_of(state, name)
    local bus = state.buses[name]
    if not bus then
        bus = { open = {}, clock = 0, marks = {} }
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

-- The time in which a request is answered, at most: that of the user, or longer if the spec states it.
local function window_of(state, request)
    return math.max(state.window, request.answer.reply_within or 0)
end

-- The oldest open exchange that a frame closes, its number, the node that replies, and the reply that the frame is.
local function answered(state, bus, edition, frame)
    for number, exchange in ipairs(bus.open) do
        local window = window_of(state, exchange.request)
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

-- The direction by content; nil if both directions are possible.
local function by_content(possible, frame)
    local is_request = possible.request ~= nil and codec.has_constants(possible.request, frame)
    local is_reply = has_constants(possible.replies, frame)
    if is_request and is_reply then
        if not codec.is_in_range(possible.request, frame) then
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

-- The time in which a reply is expected: of the command, or twice that of the spec.
local function within(state, edition, request)
    local stated = request.answer.reply_within or edition.reply_within and 2 * edition.reply_within
    return math.min(window_of(state, request), stated or state.window / 4)
end

-- The direction of a frame that can be both. Hosts can leave old bytes in reserved bits, so what these show is only assumed.
local function by_exchange(state, bus, edition, possible, exchange, frame)
    if not exchange then
        return codec.has_regular_bits(possible.request, frame) and "request" or "reply", "assumed"
    end
    local is_soon = bus.clock - exchange.since <= within(state, edition, exchange.request)
    local is_repeated, distinct = is_same(exchange.frame, frame), possible.request.answer.distinct
    if is_repeated and (not is_soon or distinct and replies_differ(exchange.request)) then
        return "request", exchange.request.answer.echo and "assumed" or "retry"
    end
    if is_soon or not codec.has_regular_bits(possible.request, frame) then
        return "reply", is_repeated and not exchange.request.answer.echo and "assumed" or "pairing"
    end
    return distinct and "request" or "reply", "assumed"
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

-- The direction that the mark of a frame states; nil without one, or before its node has both.
local function by_mark(state, bus, possible, frame)
    local seen = frame.mark and child(bus.marks, possible.request_node or possible.reply_node or frame[0])
    if not seen then
        return nil
    end
    seen[frame.mark] = true
    if not (state.trusts_marks or seen.sent and seen.received) then
        return nil
    end
    return (frame.mark == "sent") == (state.sent == "request") and "request" or "reply"
end

-- Fills the result for a frame.
local function decide(state, bus, edition, only, frame, result)
    advance(bus, frame.time)
    while bus.open[1] and bus.open[1].since + window_of(state, bus.open[1].request) < bus.clock do
        table.remove(bus.open, 1)
    end
    local possible = candidates(state, edition, frame)
    local exchange, number, source, answer
    if #possible.replies > 0 then
        exchange, number, source, answer = answered(state, bus, edition, frame)
    end
    local direction, rule = by_mark(state, bus, possible, frame), "mark"
    if not direction then
        direction, rule = only, "id"
    end
    if not direction then
        direction, rule = by_content(possible, frame)
    end
    if not direction then
        direction, rule = by_exchange(state, bus, edition, possible, exchange, frame)
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
        return
    end
    if not exchange then
        set_verdict(state, result, direction, rule, possible.reply, possible.reply_node, possible.reply_reason)
        return
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
    local asked = exchange.result
    if asked.rule == "assumed" and rule ~= "assumed" then -- its reply confirms it
        set_verdict(state, asked, asked.direction, "pairing", asked.message, asked.node, asked.reason)
    end
    exchange.missing = answer.frames == 0 and 0 or exchange.missing - 1
    if exchange.missing == 0 then
        table.remove(bus.open, number)
    end
end

-- The result for a frame: `direction` ("request", "reply" or "unknown"), `rule`, `message`, `node` and `reason` without a
-- message. That of a reply has the number of its `request` and the `latency` in ns; that of a request which
-- `expects_reply` lists the numbers of its replies, which later frames add. `only` is the direction of all frames with this
-- id, or nil.
function directions.judge(state, name, edition, only, frame)
    local result = {}
    decide(state, bus_of(state, name), edition, only, frame, result)
    return result
end

return directions
