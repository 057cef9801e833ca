-- Decides on the direction of each frame of a bus, in the order of the capture.
--
-- The rules, in this order: a mark of the recorder; the id or the content, if only one direction has it; pairing: a reply
-- within a time closes the exchange that a request opened; retry: the bytes of an open request again.

local codec = ...

local directions = {}

local MAX_OPEN = 64

-- The state of all buses. `window` is the maximum time in ns in which a request is answered.
function directions.new(window)
    return { window = window, buses = {} }
end

local function bus_of(state, name)
    local bus = state.buses[name]
    if not bus then
        bus = { open = {}, clock = 0, marks = {} }
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
    for _, answer in ipairs(edition.answers) do
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

local function is_same(one, other)
    if one[0] ~= other[0] or one.length ~= other.length then
        return false
    end
    for index = 1, one.length do
        if one[index] ~= other[index] then
            return false
        end
    end
    return true
end

-- The oldest open exchange that a frame closes, its number, and the node that replies.
local function answered(bus, edition, frame)
    for number, exchange in ipairs(bus.open) do
        if exchange.edition == edition then
            local fits, node = codec.answers(exchange.request, exchange.node, exchange.frame, frame)
            if fits and not (node and exchange.answered[node]) then
                return exchange, number, node
            end
        end
    end
    return nil
end

-- The direction by content; nil if both directions are possible.
local function by_content(found, frame)
    local is_request = found.request ~= nil and codec.has_constants(found.request, frame)
    local is_reply = has_constants(found.replies, frame)
    if is_request and is_reply then
        if not codec.is_regular(found.request, frame) then
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
    return not request.echo and #request.layout.fields > 0 and request.layout ~= request.reply.layout
end

-- The direction of a frame that can be both. A reply comes within the time of the spec, and as much again to send it.
local function by_exchange(state, bus, edition, found, exchange, frame)
    if not exchange then
        return "request", "pairing"
    end
    local repeated, distinct = is_same(exchange.frame, frame), found.request.distinct
    local within = state.window / 4
    if edition.reply_within and not exchange.request.slow then
        within = 2 * edition.reply_within
    end
    local soon = bus.clock - exchange.since <= within
    if repeated and (not soon or distinct and replies_differ(exchange.request)) then
        return "request", "retry"
    end
    return (soon or not distinct) and "reply" or "request", "pairing"
end

-- Opens an exchange. It replaces earlier ones of the same request, except echoes of other bytes.
local function open(bus, exchange)
    for number = #bus.open, 1, -1 do
        local other = bus.open[number]
        local is_to_same = other.frame[0] == exchange.frame[0] and other.node == exchange.node
        if other.request == exchange.request and is_to_same then
            if not exchange.request.echo or is_same(other.frame, exchange.frame) then
                table.remove(bus.open, number)
            end
        end
    end
    if #bus.open == MAX_OPEN then
        table.remove(bus.open, 1)
    end
    bus.open[#bus.open + 1] = exchange
end

-- The result for a frame: `direction` ("request", "reply" or "unknown"), `rule`, `message`, `node`, `reason` without a
-- message, and for a reply the `exchange` that it closes with the `latency` in ns. `mark` is "sent", "received" or nil.
-- Marks count if `trusts_marks`, or once a bus has both. `sent` is the direction of sent frames.
-- `only` is the direction of all frames with this id, or nil.
function directions.judge(state, edition, only, frame, one)
    local bus = bus_of(state, one.bus)
    advance(bus, one.time)
    while bus.open[1] and bus.open[1].since + state.window < bus.clock do
        table.remove(bus.open, 1)
    end
    local found = candidates(edition, frame)
    local exchange, number, source
    if #found.replies > 0 then
        exchange, number, source = answered(bus, edition, frame)
    end
    local direction, rule
    if one.mark then
        bus.marks[one.mark] = true
    end
    if one.mark and (one.trusts_marks or (bus.marks.sent and bus.marks.received)) then
        rule = "mark"
        if one.mark == "sent" then
            direction = one.sent
        else
            direction = one.sent == "request" and "reply" or "request"
        end
    elseif only then
        direction, rule = only, "id"
    else
        direction, rule = by_content(found, frame)
        if not direction then
            direction, rule = by_exchange(state, bus, edition, found, exchange, frame)
        end
    end
    local result = { direction = direction, rule = rule, frame = frame, edition = edition }
    if direction == "reply" then
        result.reason = found.reply_reason
        result.message, result.node = found.reply, found.reply_node
        if exchange then
            result.message, result.node = exchange.request.reply, source
            if not source and #exchange.request.nodes == 0 then
                result.node = exchange.node
            end
            result.exchange, result.latency = exchange, bus.clock - exchange.since
            if one.time[1] < exchange.time[1] then
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
        result.reason = found.request_reason
        result.message, result.node = found.request, found.request_node
        if found.request and found.request.reply and codec.has_constants(found.request, frame) then
            result.opened = {
                request = found.request,
                node = found.request_node,
                frame = frame,
                edition = edition,
                since = bus.clock,
                time = one.time,
                missing = math.max(1, #found.request.nodes),
                answered = {},
                number = one.number,
            }
            open(bus, result.opened)
        end
    end
    return result
end

return directions
